#include "mesh_ops/deform/bends/curved_form.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "mesh_ops/base/elementary.h"
#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

// The piece of a segment with the direction `along`, for rotations about `turn`.
CurvedForm::Piece bend_of(CurvedForm::Piece piece, const Vec3& along, const Vec3& turn) {
  constexpr double rounding = 1e-14;  // rounding of products of unit vectors
  if (std::abs(turn.dot(along)) > rounding)
    piece.turn = turn;
  else
    piece.form.direction = turn.cross(along);
  return piece;
}

// The vector times a power of two that makes it neither overflow nor underflow when squared.
Vec3 scaled(const Vec3& v, double scale) {
  return {std::ldexp(v.x(), -std::ilogb(scale)), std::ldexp(v.y(), -std::ilogb(scale)),
          std::ldexp(v.z(), -std::ilogb(scale))};
}
Vec3 scaled(const Vec3& v) { return scaled(v, v.cwiseAbs().maxCoeff()); }

std::vector<bool> opposed_segments(const std::vector<Vec3>& spine) {
  const std::size_t n = spine.size() - 1;
  std::vector<bool> result(n * n);
  bool any = false;
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t k = 0; k < n; ++k)
      if (scaled(spine[j + 1] - spine[j]).dot(scaled(spine[k + 1] - spine[k])) < 0) any = result[j * n + k] = true;
  if (!any) result.clear();
  return result;
}

std::size_t nearest_segment(const std::vector<Vec3>& spine, const Vec3& point) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity(), size = 0;
  for (const Vec3& p : spine) size = std::max(size, (p - spine.front()).cwiseAbs().maxCoeff());
  for (std::size_t k = 0; k + 1 < spine.size(); ++k) {
    const Vec3 way = scaled(spine[k + 1] - spine[k], size), to_point = scaled(point - spine[k], size);
    const double share = std::clamp(to_point.dot(way) / way.squaredNorm(), 0.0, 1.0);
    const double distance = (to_point - share * way).squaredNorm();
    if (distance < least) {
      least = distance;
      nearest = k;
    }
  }
  return nearest;
}

// Where a point lies along a segment: `inside` within the form's limits.
struct Position {
  double inside = 0;
  bool within = false;  // strictly between the limits, so that `inside` depends on the point
};

// Applies one segment to a point. Its angle follows from the undeformed point's position, so that everything beyond the
// segment moves rigidly with it, even after later segments have rotated it.
Deformed deform_after(const ClosedForm& form, const Position& at, const Deformed& so_far) {
  const double length = form.to - form.from, inside = at.inside, share = (inside - form.from) / length;
  if (share == 0 && !at.within) return so_far;
  const Mat3 frame = frame_of(form);
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
  if (at.within) jacobian += frame.transpose() * by_inside * frame.row(2);
  return {share == 0 ? so_far.point : Vec3(so_far.point + frame.transpose() * motion), jacobian};
}

// A segment whose points at `inside` rotate about `turn` by an angle proportional to it, so that the segment becomes a
// helix: its tangent is the rotated segment.
Deformed deform_after_helix(const CurvedForm::Piece& piece, const Position& at, const Deformed& so_far) {
  const ClosedForm& form = piece.form;
  const double passed = at.inside - form.from, rate = form.radians / (form.to - form.from);
  if ((passed == 0 && !at.within) || rate == 0) return so_far;
  const Vec3 &turn = piece.turn, along = form.axis.stableNormalized(), sideways = turn.cross(along);
  const Vec3 across = sideways.cross(turn);  // the part of `along` that is perpendicular to `turn`
  const double angle = rate * passed, sine = elementary::sine_cosine(angle).sine,
               half = elementary::sine_cosine(angle / 2).sine, versine = 2 * half * half;
  const auto rotation_motion = [&](const auto& v) {
    return (sine * turn.cross(v) + versine * turn.cross(turn.cross(v))).eval();
  };
  const Vec3 from_segment = so_far.point - form.origin - at.inside * along;
  const Vec3 motion = across * (sine / rate - passed) + sideways * (versine / rate) + rotation_motion(from_segment);
  Mat3 jacobian = so_far.jacobian;
  for (int column = 0; column < 3; ++column) jacobian.col(column) += rotation_motion(Vec3(so_far.jacobian.col(column)));
  if (at.within) {
    const Vec3 rotated = from_segment + rotation_motion(from_segment);
    jacobian += rate * turn.cross(rotated) * along.transpose();
  }
  return {passed == 0 ? so_far.point : Vec3(so_far.point + motion), jacobian};
}

// The segments on which a point is projected: those around the nearest one, up to the first that points back. Beyond
// it, a parallel one is another part of a spine that winds.
std::pair<std::size_t, std::size_t> projected_segments(const CurvedForm& form, std::size_t nearest,
                                                       std::size_t segments) {
  if (form.opposed.empty()) return {0, segments};
  std::size_t first = nearest, last = nearest;
  while (first > 0 && !form.opposed[nearest * segments + first - 1]) --first;
  while (last + 1 < segments && !form.opposed[nearest * segments + last + 1]) ++last;
  return {first, last};
}

}  // namespace

CurvedForm along_curve(const ClosedForm& form, const std::vector<Vec3>& spine) {
  if (form.kind == ClosedForm::Kind::taper)
    throw FieldError("spine", "applies only to bends, twists and stretches; leave it out");
  if (spine.size() < 2) throw FieldError("spine", "must have at least two points");
  const bool bends = form.kind == ClosedForm::Kind::bend;
  const Vec3 turn = bends ? Vec3(form.axis.cross(form.direction).stableNormalized()) : Vec3(0, 0, 0);
  CurvedForm result;
  double at = 0;
  for (std::size_t k = 0; k + 1 < spine.size(); ++k) {
    CurvedForm::Piece piece{form, k};
    const Vec3 way = spine[k + 1] - spine[k];
    const double length = way.stableNorm(), begins = at;
    if (!way.allFinite() || !(length > 0))
      throw FieldError("spine", "must have finite points, and no equal neighbours");
    at += length;
    piece.form.origin = spine[k];
    piece.form.axis = way;
    piece.form.from = std::max(form.from - begins, 0.0);
    piece.form.to = std::min(form.to - begins, length);
    if (!(piece.form.from < piece.form.to)) continue;
    piece.form.radians = form.radians * ((piece.form.to - piece.form.from) / (form.to - form.from));
    result.pieces.push_back(bends ? bend_of(piece, way / length, turn) : piece);
  }
  if (result.pieces.empty())
    throw FieldError("spine", "ends before the deformation begins; lower from or lengthen the spine");
  std::reverse(result.pieces.begin(), result.pieces.end());
  result.spine = spine;
  result.opposed = opposed_segments(spine);
  return result;
}

Deformed deform(const CurvedForm& form, const Vec3& point) {
  if (form.pieces.size() == 1 && form.opposed.empty() && form.pieces.front().turn.isZero(0))
    return deform(form.pieces.front().form, point);
  const std::size_t segments = form.spine.size() - 1;
  const std::size_t nearest = form.opposed.empty() ? 0 : nearest_segment(form.spine, point);
  const auto [first, last] = projected_segments(form, nearest, segments);
  Deformed result{point, Mat3::Identity()};
  for (const CurvedForm::Piece& piece : form.pieces) {
    const ClosedForm& one = piece.form;
    Position at;
    if (piece.segment < first || piece.segment > last) {
      at.inside = piece.segment < nearest ? one.to : one.from;
    } else {
      const double along = one.axis.stableNormalized().dot(point - one.origin);
      at.inside = std::clamp(along, one.from, one.to);
      // At a joint of two segments the later one counts.
      const double rounding = limit_rounding(one, point);
      const bool ends = &piece == &form.pieces.front();
      at.within = along >= one.from - rounding && along <= one.to + (ends ? rounding : -rounding);
    }
    result = piece.turn.isZero(0) ? deform_after(one, at, result) : deform_after_helix(piece, at, result);
  }
  return result;
}

}  // namespace rebake
