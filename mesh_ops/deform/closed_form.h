#pragma once

#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// Deformations with a formula (Barr 1984), about an axis through `origin`. z is the position along `axis` from the
/// origin; what lies below `from` stays, what lies above `to` follows rigidly (or keeps the end's size).
struct ClosedForm {
  enum class Kind { bend, twist, taper, stretch };
  Kind kind = Kind::bend;
  Vec3 origin{0, 0, 0};
  Vec3 axis{0, 1, 0};       ///< any length
  Vec3 direction{1, 0, 0};  ///< bend: where to; its part across the axis counts
  double from = 0, to = 1;  ///< along the axis, from < to
  double radians = 0;       ///< bend and twist: in all
  double factor = 1;        ///< taper: size at `to`; stretch: length of what was from … to
};

/// What became of one point. The Jacobian is exact up to rounding; its determinant is 1 for twists, r² for tapers,
/// 1 − κ x for bends (x towards `direction`), which folds where x ≥ 1/κ.
struct Deformed {
  Vec3 point;
  Mat3 jacobian;
};

/// Throws Error when a field is out of its range.
void check(const ClosedForm& form);

Deformed deform(const ClosedForm& form, const Vec3& point);

/// The same along a curved line: a form for each straight piece of `spine` between `form.from` and `form.to`, which are
/// lengths along it from its first point, in the order in which deform() below applies them: the last piece first,
/// since what lies beyond a piece follows it. Bends turn about one line throughout, across the form's axis and
/// direction: exactly where the curve is across it too, else up to products of the angles of one piece. Along a
/// straight spine this is the form itself. Throws FieldError for tapers, for fewer than two points, and for points that
/// coincide.
std::vector<ClosedForm> along_curve(const ClosedForm& form, const std::vector<Vec3>& spine);
/// One after the other; at least one. Each goes by where the point was before all of them.
Deformed deform(const std::vector<ClosedForm>& forms, const Vec3& point);

}  // namespace rebake
