#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// A closed border between removed and kept triangles.
struct HoleLoop {
  std::vector<Vec3> points;        ///< in order, each once; at least three
  std::vector<Vec3> outer_points;  ///< per edge from point k to k + 1: the third corner of its kept triangle
  /// Per point: kept triangles at it, as the object's numbers with the corner in them.
  struct Corner {
    std::uint32_t triangle, corner;
  };
  std::vector<std::vector<Corner>> corners;
};

struct HoleLoops {
  std::vector<HoleLoop> loops;  ///< longest first
  std::size_t open_edges = 0;   ///< border edges that belong to no closed loop
};

/// The borders that appear when the flagged triangles are removed: edges between flagged and kept triangles that show
/// opaque texels. Corners at most `tolerance` object units apart are one point. Where more than two border edges meet,
/// loops are separated there.
HoleLoops hole_loops(const BakedObject& object, const TriangleSet& removed, double tolerance);

/// The open borders of the flagged triangles: edges that a single opaque triangle has, which is flagged.
HoleLoops open_loops(const BakedObject& object, const TriangleSet& flagged, double tolerance);

}  // namespace rebake
