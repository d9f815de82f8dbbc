#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Points on opaque surfaces in world space, with unit normals of their triangles.
struct SurfaceSamples {
  std::vector<Vec3> points, normals;
};

/// About `count` points, evenly by area over the visible opaque surfaces of placed nodes, the same on every run.
SurfaceSamples sampled_surfaces(const std::vector<PlacedNode>& nodes, std::size_t count, std::uint64_t seed);

}  // namespace rebake
