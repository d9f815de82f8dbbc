#pragma once

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

/// Rotation into the axes of the form. Rows: towards the direction, across both, along the axis.
Mat3 frame_of(const ClosedForm& form);

/// Rounding of a point's coordinate along the axis. Vertices at the limits up to this take the Jacobian from inside, as
/// all triangles are inside by default.
double limit_rounding(const ClosedForm& form, const Vec3& point);

}  // namespace rebake
