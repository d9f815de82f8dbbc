#pragma once

#include <memory>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Parameters of the synthetic scene; the defaults are measurements of a real unbounded scene.
struct LargeSceneOptions {
  std::size_t sets = 8;             ///< number of texture sets, exported in 8 chunks each
  std::size_t triangles = 723'000;  ///< total number of triangles; rounded down to whole quads
  int texture_side = 4096;          ///< width and height of each texture in texels
  double extent = 16;               ///< coordinates are within ±extent
  double opaque_share = 0.59;       ///< opaque share of all texels, 0 … 1
  double vertices_per_point = 1.9;  ///< mean number of vertices per distinct position (welded point)
  unsigned seed = 1;
};

/// Creates a synthetic scene as large as a real one, for benchmarks without real data. It has small grids of quads,
/// dense around the middle and sparse on a backdrop; each quad has its own 17×17 texels. Features are smooth with noise
/// and cover their whole range. The same on every machine.
std::shared_ptr<const BakedObject> large_synthetic_scene(const LargeSceneOptions& options = {});

}  // namespace rebake
