#include "mesh_ops/deform/bends/closed_form.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh_ops/base/elementary.h"
#include "mesh_ops/base/error.h"

namespace rebake {

Mat3 frame_of(const ClosedForm& form) {
  const Vec3 z = form.axis.stableNormalized();
  Vec3 x = form.direction - form.direction.dot(z) * z;
  if (!(x.stableNorm() > 1e-9 * form.direction.stableNorm())) x = z.unitOrthogonal();
  x = x.stableNormalized();
  Mat3 frame;
  frame << x.transpose(), z.cross(x).transpose(), z.transpose();
  return frame;
}

double limit_rounding(const ClosedForm& form, const Vec3& point) {
  return 16 * std::numeric_limits<double>::epsilon() *
         (point.cwiseAbs().maxCoeff() + form.origin.cwiseAbs().maxCoeff() +
          std::max(std::abs(form.from), std::abs(form.to)));
}

void check(const ClosedForm& form) {
  if (!form.origin.allFinite()) throw FieldError("origin", "must be finite");
  if (!form.axis.allFinite() || !(form.axis.stableNorm() > 0)) throw FieldError("axis", "must be finite and not zero");
  if (!(form.from < form.to) || !std::isfinite(form.to - form.from)) throw FieldError("from", "must be less than to");
  if (form.kind == ClosedForm::Kind::bend) {
    const Vec3 z = form.axis.stableNormalized();
    if (!(Vec3(form.direction - form.direction.dot(z) * z).stableNorm() > 1e-9 * form.direction.stableNorm()))
      throw FieldError("direction", "must not be parallel to the axis");
  }
  if (!std::isfinite(form.radians)) throw FieldError("degrees", "must be finite");
  if (!std::isfinite(form.factor) || form.factor < 0) throw FieldError("factor", "must be finite and not negative");
}

Deformed deform(const ClosedForm& form, const Vec3& point) {
  const Mat3 frame = frame_of(form);
  const Vec3 p = frame * (point - form.origin);
  const double length = form.to - form.from;
  const double inside = std::clamp(p.z(), form.from, form.to);
  const double rounding = limit_rounding(form, point);
  // Derivative of `inside` by z.
  const double slope = p.z() >= form.from - rounding && p.z() <= form.to + rounding ? 1 : 0;
  const double share = (inside - form.from) / length, beyond = p.z() - inside;
  // Motion and Jacobian minus identity, so that unmoved points keep their bits and small angles lose no digits:
  // cos a − 1 = −2 sin²(a/2).
  Vec3 motion(0, 0, 0);
  Mat3 j = Mat3::Zero();
  const double angle = form.radians * share, s = elementary::sine_cosine(angle).sine,
               half = elementary::sine_cosine(angle / 2).sine, c1 = -2 * half * half;
  switch (form.kind) {
    case ClosedForm::Kind::twist: {
      const double rate = slope * form.radians / length;
      motion = {c1 * p.x() - s * p.y(), s * p.x() + c1 * p.y(), 0};
      j << c1, -s, -rate * (p.y() + motion.y()), s, c1, rate * (p.x() + motion.x()), 0, 0, 0;
      break;
    }
    case ClosedForm::Kind::taper: {
      const double r1 = (form.factor - 1) * share, rate = slope * (form.factor - 1) / length;
      motion = {r1 * p.x(), r1 * p.y(), 0};
      j << r1, 0, rate * p.x(), 0, r1, rate * p.y(), 0, 0, 0;
      break;
    }
    case ClosedForm::Kind::stretch: {
      motion.z() = (form.factor - 1) * length * share;
      j(2, 2) = slope * (form.factor - 1);
      break;
    }
    case ClosedForm::Kind::bend: {
      if (share == 0 && slope == 0) break;
      // The axis becomes an arc of the same length: (1 − cos a)/κ sideways and sin a / κ along the axis.
      const double kappa = form.radians / length, arc = inside - form.from;
      const double aside = kappa != 0 ? -c1 / kappa : 0, shortened = kappa != 0 ? s / kappa - arc : 0;
      motion = {aside + c1 * p.x() + s * beyond, 0, shortened - s * p.x() + c1 * beyond};
      const double stretched = slope > 0 ? 1 - kappa * p.x() : 1;
      j << c1, 0, s * stretched, 0, 0, 0, -s, 0, c1 * stretched + (stretched - 1);
      break;
    }
  }
  return {point + frame.transpose() * motion, Mat3::Identity() + frame.transpose() * j * frame};
}

}  // namespace rebake
