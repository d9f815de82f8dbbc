#pragma once

#include <vector>

#include "mesh_ops/deform/bends/closed_form.h"

namespace rebake {

/// A bend, twist or stretch along a polyline: one closed form per straight segment. Everything beyond a segment follows
/// it.
struct CurvedForm {
  struct Piece {
    ClosedForm form;          ///< its `from` and `to` are measured from the segment's start
    std::size_t segment = 0;  ///< index of the segment: from spine[segment] to spine[segment + 1]
    /// Unit axis of a bend that is not perpendicular to the segment, which then becomes a helix; else zero.
    Vec3 turn = Vec3::Zero();
  };
  std::vector<Vec3> spine;
  std::vector<Piece> pieces;  ///< in the order in which deform() applies them, the last segment first
  /// For each two segments whether their directions differ by more than 90°; row-major, empty if no two do.
  std::vector<bool> opposed;
};

/// `form` along `spine`. `form.from` and `form.to` are arc lengths from the spine's first point. Throws FieldError for
/// tapers, for fewer than two points, for points that coincide or are not finite, and for a spine shorter than
/// `form.from`.
/// All bends rotate about one direction, perpendicular to the form's axis and direction, so their angles add up. For a
/// straight spine perpendicular to it this is the form itself.
CurvedForm along_curve(const ClosedForm& form, const std::vector<Vec3>& spine);

/// The position along a segment is that of the undeformed point, projected. Segments that point back, by more than 90°
/// from the segment nearest to the point, would get wrong projections: they count as entirely before or behind the
/// point, by their order; so do segments beyond them. The result is continuous within the spine's radius of curvature;
/// at a corner of more than 90° it is not.
Deformed deform(const CurvedForm& form, const Vec3& point);

}  // namespace rebake
