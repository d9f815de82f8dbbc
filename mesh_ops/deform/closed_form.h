#pragma once

#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// A closed-form deformation (Barr 1984) about an axis through `origin`. z is the position along `axis`, measured from
/// the origin. Points with z below `from` do not move. Points above `to` follow rigidly, or keep the size of the end
/// (taper).
struct ClosedForm {
  enum class Kind { bend, twist, taper, stretch };
  Kind kind = Kind::bend;
  Vec3 origin{0, 0, 0};     ///< a point on the axis
  Vec3 axis{0, 1, 0};       ///< direction of the axis; any length above 0
  Vec3 direction{1, 0, 0};  ///< bend only: direction towards which it bends; its component across the axis counts
  double from = 0, to = 1;  ///< range of z that is deformed; from < to
  double radians = 0;       ///< total angle of a bend or twist
  double factor = 1;        ///< taper: relative size at `to`; stretch: relative length of from … to
};

/// A deformed point and its Jacobian, exact up to rounding. Determinant: 1 for twists, r² for tapers (r the relative
/// size), the factor for stretches, 1 − κ x for bends (curvature κ, x towards `direction`). A bend folds where x ≥ 1/κ.
struct Deformed {
  Vec3 point;
  Mat3 jacobian;
};

/// Throws FieldError if a field is out of its range.
void check(const ClosedForm& form);

Deformed deform(const ClosedForm& form, const Vec3& point);

/// The deformation along a polyline `spine`: one form per straight segment between `form.from` and `form.to`, which are
/// arc lengths from its first point. Forms come in the order in which deform() applies them: the last segment first,
/// since everything beyond a segment follows it. Throws FieldError for tapers, for fewer than two points, for points
/// that coincide or are not finite, and for a spine shorter than `form.from`.
/// All bends rotate about one direction, perpendicular to the form's axis and direction. That is exact if the curve is
/// perpendicular to it too, otherwise up to products of the angles of one segment. For a straight spine this is the
/// form itself.
std::vector<ClosedForm> along_curve(const ClosedForm& form, const std::vector<Vec3>& spine);
/// Applies forms in order; at least one. Each form takes its parameter z from the undeformed point.
Deformed deform(const std::vector<ClosedForm>& forms, const Vec3& point);

}  // namespace rebake
