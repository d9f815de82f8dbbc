#pragma once

#include <vector>

#include "mesh_ops/deform/cage_deformation.h"
#include "mesh_ops/deform/deform_places.h"

namespace rebake {

/// A piece of the border of what is deformed: an edge that a deformed and another triangle share, or, where both ends
/// are the same, a corner that they do.
struct BorderPiece {
  Vec3 begin, end;

  Vec3 nearest(const Vec3& p) const;
};

/// The border of the flagged triangles in world space: edges first, then corners that no such edge has.
std::vector<BorderPiece> border_of(const WeldedCorners& corners, const TriangleSet& flags, const FlaggedPlaces& places);

/// Fades a deformation of points out towards the border, smoothly: whole at `falloff` from it and beyond, nothing on
/// it. Jacobians follow.
void fade_out(const std::vector<Vec3>& rest, const std::vector<BorderPiece>& border, double falloff,
              DeformedPoints& deformed);

}  // namespace rebake
