#pragma once

#include <memory>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// What the synthetic scene is made like: a real unbounded scene, as measured.
struct LargeSceneOptions {
  std::size_t sets = 8;             ///< texture sets, exported in 8 chunks each
  std::size_t triangles = 723'000;  ///< in all; rounded down to whole quads
  int texture_side = 4096;          ///< texels
  double extent = 16;               ///< coordinates lie within ± this
  double opaque_share = 0.59;       ///< of all texels
  double vertices_a_point = 1.9;    ///< vertices at one place, on average: how much welding saves
  unsigned seed = 1;
};

/// A synthetic scene of that size, for measurements where no real one is at hand: nothing in it was photographed. Small
/// pieces of grids, dense around the middle and sparse as a backdrop, each quad with its own 17×17 texels; features
/// are smooth with noise, over their whole range. The same on every machine.
std::shared_ptr<const BakedObject> large_synthetic_scene(const LargeSceneOptions& options = {});

}  // namespace rebake
