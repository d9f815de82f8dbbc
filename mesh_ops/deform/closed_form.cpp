#include "mesh_ops/deform/closed_form.h"

#include <algorithm>
#include <cmath>

#include "mesh_ops/error.h"

namespace rebake {

namespace {

// Rows: towards the direction, across both, along the axis.
Mat3 frame_of(const ClosedForm& form) {
  const Vec3 z = form.axis.stableNormalized();
  Vec3 x = form.direction - form.direction.dot(z) * z;
  if (!(x.stableNorm() > 1e-9 * form.direction.stableNorm())) x = z.unitOrthogonal();
  x = x.stableNormalized();
  Mat3 frame;
  frame << x.transpose(), z.cross(x).transpose(), z.transpose();
  return frame;
}

}  // namespace

void check(const ClosedForm& form) {
  if (!form.origin.allFinite()) throw FieldError("origin", "must be finite");
  if (!form.axis.allFinite() || !(form.axis.stableNorm() > 0)) throw FieldError("axis", "must have a length");
  if (!(form.from < form.to) || !std::isfinite(form.to - form.from)) throw FieldError("from", "must lie below to");
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
  const double slope = p.z() > form.from && p.z() < form.to ? 1 : 0;  // of `inside` by z
  const double share = (inside - form.from) / length, beyond = p.z() - inside;
  Vec3 q = p;
  Mat3 j = Mat3::Identity();
  switch (form.kind) {
    case ClosedForm::Kind::twist: {
      const double angle = form.radians * share, c = std::cos(angle), s = std::sin(angle);
      const double rate = slope * form.radians / length;
      q.x() = c * p.x() - s * p.y();
      q.y() = s * p.x() + c * p.y();
      j << c, -s, -rate * q.y(), s, c, rate * q.x(), 0, 0, 1;
      break;
    }
    case ClosedForm::Kind::taper: {
      const double r = 1 + (form.factor - 1) * share, rate = slope * (form.factor - 1) / length;
      q.x() = r * p.x();
      q.y() = r * p.y();
      j << r, 0, rate * p.x(), 0, r, rate * p.y(), 0, 0, 1;
      break;
    }
    case ClosedForm::Kind::stretch: {
      const double extra = (form.factor - 1) * length;
      q.z() = p.z() + extra * share;
      j(2, 2) = slope > 0 ? form.factor : 1;
      break;
    }
    case ClosedForm::Kind::bend: {
      // The axis becomes an arc of the same length; chords by sin(a/2) so that small angles lose nothing.
      const double angle = form.radians * share, kappa = form.radians / length;
      const double c = std::cos(angle), s = std::sin(angle), half = std::sin(angle / 2);
      const double arc = inside - form.from;
      // Where the axis is at this angle: chord and sagitta of the arc.
      const double along = kappa != 0 ? s / kappa : arc, aside = kappa != 0 ? 2 * half * half / kappa : 0;
      q.x() = aside + c * p.x() + s * beyond;
      q.z() = form.from + along - s * p.x() + c * beyond;
      if (p.z() < form.from) {
        q = p;
        break;
      }
      const double stretched = slope > 0 ? 1 - kappa * p.x() : 1;
      j << c, 0, s * stretched, 0, 1, 0, -s, 0, c * stretched;
      break;
    }
  }
  // What the formula leaves alone stays bit for bit.
  if (q == p) return {point, frame.transpose() * j * frame};
  return {point + frame.transpose() * (q - p), frame.transpose() * j * frame};
}

}  // namespace rebake
