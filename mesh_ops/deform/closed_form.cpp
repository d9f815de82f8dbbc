#include "mesh_ops/deform/closed_form.h"

#include <algorithm>
#include <cmath>

#include "mesh_ops/base/elementary.h"
#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

// Rotation into the axes of the form. Rows: towards the direction, across both, along the axis.
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
  const double slope = p.z() > form.from && p.z() < form.to ? 1 : 0;  // derivative of `inside` by z
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
      if (share == 0) break;
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

std::vector<ClosedForm> along_curve(const ClosedForm& form, const std::vector<Vec3>& spine) {
  if (form.kind == ClosedForm::Kind::taper)
    throw FieldError("spine", "applies only to bends, twists and stretches; leave it out");
  if (spine.size() < 2) throw FieldError("spine", "must have at least two points");
  const bool bends = form.kind == ClosedForm::Kind::bend;
  const Vec3 turn = bends ? Vec3(form.axis.cross(form.direction).stableNormalized()) : Vec3(0, 0, 0);
  std::vector<ClosedForm> pieces;
  double at = 0;
  for (std::size_t k = 0; k + 1 < spine.size(); ++k) {
    ClosedForm piece = form;
    const Vec3 way = spine[k + 1] - spine[k];
    const double length = way.stableNorm(), begins = at;
    if (!way.allFinite() || !(length > 0))
      throw FieldError("spine", "must have finite points, and no equal neighbours");
    at += length;
    piece.origin = spine[k];
    piece.axis = way;
    piece.from = std::max(form.from - begins, 0.0);
    piece.to = std::min(form.to - begins, length);
    if (!(piece.from < piece.to)) continue;
    const double angle = form.radians * ((piece.to - piece.from) / (form.to - form.from));
    piece.radians = angle;
    if (!bends) {
      pieces.push_back(piece);
      continue;
    }
    // A rotation about a direction that is not perpendicular to the segment splits into a bend and a twist about the
    // segment.
    const Vec3 along = way / length;
    const double twisted = turn.dot(along);
    const Vec3 across = turn - twisted * along;
    const double bent = across.norm();
    constexpr double rounding = 1e-14;  // rounding of products of unit vectors
    if (std::abs(twisted) > rounding) {
      ClosedForm twist = piece;
      twist.kind = ClosedForm::Kind::twist;
      twist.radians = angle * twisted;
      pieces.push_back(twist);
    }
    if (bent > rounding) {
      piece.radians = angle * bent;
      piece.direction = across.cross(along);
      pieces.push_back(piece);
    }
  }
  if (pieces.empty()) throw FieldError("spine", "ends before the deformation begins; lower from or lengthen the spine");
  std::reverse(pieces.begin(), pieces.end());
  return pieces;
}

namespace {

// Applies one segment to a point. Its angle follows from the undeformed position `rest`, so that everything beyond the
// segment moves rigidly with it, even after later segments have rotated it.
Deformed deform_after(const ClosedForm& form, const Vec3& rest, const Deformed& so_far) {
  const Mat3 frame = frame_of(form);
  const double along = form.axis.stableNormalized().dot(rest - form.origin), length = form.to - form.from;
  const double inside = std::clamp(along, form.from, form.to), share = (inside - form.from) / length;
  if (share == 0) return so_far;
  const bool within = along > form.from && along < form.to;
  const Vec3 p = frame * (so_far.point - form.origin);
  const double angle = form.radians * share, rate = form.radians / length, s = elementary::sine_cosine(angle).sine,
               half = elementary::sine_cosine(angle / 2).sine, c1 = -2 * half * half, c = 1 + c1;
  Vec3 motion(0, 0, 0), by_inside(0, 0, 0);  // motion, and its derivative by `inside`
  Mat3 j = Mat3::Zero();                     // derivative of the motion by p
  if (form.kind == ClosedForm::Kind::twist) {
    motion = {c1 * p.x() - s * p.y(), s * p.x() + c1 * p.y(), 0};
    j << c1, -s, 0, s, c1, 0, 0, 0, 0;
    by_inside = rate * Vec3(-s * p.x() - c * p.y(), c * p.x() - s * p.y(), 0);
  } else if (form.kind == ClosedForm::Kind::stretch) {
    motion.z() = (form.factor - 1) * (inside - form.from);
    by_inside.z() = form.factor - 1;
  } else {
    const double beyond = p.z() - inside;
    const double aside = rate != 0 ? -c1 / rate : 0, shortened = rate != 0 ? s / rate - (inside - form.from) : 0;
    motion = {aside + c1 * p.x() + s * beyond, 0, shortened - s * p.x() + c1 * beyond};
    j << c1, 0, s, 0, 0, 0, -s, 0, c1;
    by_inside = rate * Vec3(c * beyond - s * p.x(), 0, -c * p.x() - s * beyond);
  }
  Mat3 jacobian = so_far.jacobian + frame.transpose() * j * frame * so_far.jacobian;
  if (within) jacobian += frame.transpose() * by_inside * frame.row(2);
  return {so_far.point + frame.transpose() * motion, jacobian};
}

}  // namespace

Deformed deform(const std::vector<ClosedForm>& forms, const Vec3& point) {
  if (forms.size() == 1) return deform(forms.front(), point);
  Deformed result{point, Mat3::Identity()};
  for (const ClosedForm& form : forms) result = deform_after(form, point, result);
  return result;
}

}  // namespace rebake
