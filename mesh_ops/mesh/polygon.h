#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// Shape of a polygon, seen along its normal.
enum class PolygonShape {
  convex,   ///< also if corners coincide or lie on an edge, within 1e-12 of its size
  concave,  ///< its sides do not cross
  crossing  ///< its sides cross or touch, or it has no area
};

/// A polygon as triangles of its corners.
struct CutPolygon {
  PolygonShape shape = PolygonShape::convex;
  std::vector<std::array<std::size_t, 3>> triangles;  ///< corners − 2, oriented like the polygon
};

/// Cutting a concave polygon takes cubic time.
inline constexpr std::size_t most_concave_corners = 256;

/// Cuts a polygon of at least three corners, which need not lie in one plane: concave ones by clipping ears, others as
/// a fan around the first corner, as viewers do. The normal is Newell's. Throws Error for a polygon that is not convex
/// and has more than most_concave_corners.
CutPolygon cut_polygon(const std::vector<Vec3>& corners);

}  // namespace rebake
