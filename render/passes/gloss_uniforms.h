#pragma once

#include <array>

#include "mesh_ops/light/transport/gloss.h"

namespace rebake {

/// Values of the uniforms of gloss.glsl, except for the textures.
struct GlossUniforms {
  std::array<Eigen::Vector3f, sh::count> sky;  ///< coefficients times their normalisation constants
  std::array<Eigen::Vector3f, Gloss::max_suns> directions, lights;
  int suns = 0;
  float sharpness = 0;
};
GlossUniforms gloss_uniforms(const Gloss& gloss);

}  // namespace rebake
