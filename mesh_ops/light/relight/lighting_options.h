#pragma once

#include <set>

#include "mesh_ops/base/result_cache.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Accuracy and scope of lighting_of().
struct LightingOptions {
  int rays = 0;        ///< 0: the scene's setting
  double spacing = 4;  ///< distance of light nodes in texels; larger for objects with more than `max_nodes`
  std::size_t max_nodes = 400000;
  bool everything = false;         ///< run all effects, for audits
  ResultCache* results = nullptr;  ///< cache of estimates and traced light; null for none
  bool keep_traced = true;         ///< false: cache estimates only
  std::set<NodeId> turning{};      ///< nodes whose triangles are about to be dragged
};

}  // namespace rebake
