#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Triangle corners after welding: each corner refers to a place, the number of a distinct position.
struct WeldedCorners {
  std::vector<std::uint32_t> places;  ///< per corner: [3 · triangle + corner]
  std::uint32_t place_count = 0;      ///< number of distinct places
};
/// Corners of one texture set, welded if bit-identical; places are numbered in order of first use by triangles.
struct WeldedSet {
  WeldedCorners corners;
  std::vector<Vec3> points;  ///< position per place
};
WeldedSet weld_set(const Soup& soup);

/// Welds the corners of all sets. Corners at most `tolerance` (object units) apart become one place; 0: only
/// bit-identical ones.
WeldedCorners weld(const BakedObject& object, const std::vector<std::shared_ptr<const WeldedSet>>& sets,
                   double tolerance);

}  // namespace rebake
