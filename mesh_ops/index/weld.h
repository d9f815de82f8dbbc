#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Corners of an object's triangles, welded: three place numbers a triangle.
struct WeldedCorners {
  std::vector<std::uint32_t> places;  ///< 3 a triangle
  std::uint32_t place_count = 0;
};
/// Corners at most `tolerance` apart are one place; 0: equal bit for bit.
WeldedCorners weld(const BakedObject& object, double tolerance);

}  // namespace rebake
