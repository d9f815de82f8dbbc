#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Where a sample lies: a face and a texel of an object.
struct SurfacePlace {
  std::uint32_t node, set, face;  ///< index of the placed node, of its object's set, and of the set's face
  int x, y;                       ///< texel of the set's texture
};

/// Points on opaque surfaces in world space, with unit normals of their triangles.
struct SurfaceSamples {
  std::vector<Vec3> points, normals;
  std::vector<SurfacePlace> places;  ///< per point
};

/// About `count` points, evenly by area over the visible opaque surfaces of placed nodes, the same on every run.
SurfaceSamples sampled_surfaces(const std::vector<PlacedNode>& nodes, std::size_t count, std::uint64_t seed);

}  // namespace rebake
