#pragma once

#include <vector>

#include "mesh_ops/deform/cage_coordinates/cage_deformation.h"
#include "mesh_ops/deform/deform_positions.h"

namespace rebake {

/// A piece of the border of the deformed triangles: an edge shared by a deformed and an unchanged triangle. If both
/// ends are equal, it is a shared corner.
struct BorderPiece {
  Vec3 begin, end;

  Vec3 nearest(const Vec3& p) const;
};

/// The border of the flagged triangles in world space: shared edges, and shared corners that belong to no such edge.
std::vector<BorderPiece> border_of(const WeldedCorners& corners, const TriangleSet& flags,
                                   const FlaggedPositions& places);

/// Fades a deformation out towards the border: the full motion at distance `falloff` and beyond, none on the border,
/// with a cubic smoothstep between. Adjusts positions and Jacobians of `deformed`, whose entries belong to the points
/// `rest`.
void fade_out(const std::vector<Vec3>& rest, const std::vector<BorderPiece>& border, double falloff,
              DeformedPoints& deformed);

}  // namespace rebake
