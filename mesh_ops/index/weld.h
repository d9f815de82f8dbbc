#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Corners of an object's triangles, welded: three place numbers a triangle.
struct WeldedCorners {
  std::vector<std::uint32_t> places;  ///< 3 a triangle
  std::uint32_t place_count = 0;
};
/// One set's corners, those that are equal bit for bit as one place, and where these are, in the order in which
/// triangles come to them.
struct WeldedSet {
  WeldedCorners corners;
  std::vector<Vec3> points;
};
WeldedSet weld_set(const Soup& soup);

/// Of all sets. Corners at most `tolerance` apart are one place; 0: equal bit for bit.
WeldedCorners weld(const BakedObject& object, const std::vector<std::shared_ptr<const WeldedSet>>& sets,
                   double tolerance);

}  // namespace rebake
