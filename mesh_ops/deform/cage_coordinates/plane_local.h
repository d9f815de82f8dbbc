#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "mesh_ops/deform/cage_coordinates/cage_frame.h"
#include "mesh_ops/deform/cage_coordinates/dual.h"

// Integrals over one triangle, in its own plane: no chords of unit vectors, no determinants, no absolute epsilon. T is
// double, float, or Dual for gradients. Points are in the cage frame. Angles and distances follow the usual derivations
// (Ju et al. 2005 for mean values, Urago 2000 and Lipman et al. 2008 for Green's), arranged so that nothing cancels
// near faces, edges, vertices and planes.

namespace rebake::plane_local {

template <class T>
struct RealOf {
  using type = T;
};
template <class R>
struct RealOf<DualOf<R>> {
  using type = R;
};
template <class T>
inline constexpr bool has_gradient = !std::is_same_v<T, typename RealOf<T>::type>;
template <class T>
inline const double epsilon = static_cast<double>(std::numeric_limits<typename RealOf<T>::type>::epsilon());

/// A lower bound for squared heights, far below the square of any height that rounding produces.
template <class T>
inline const double min_square = std::max(static_cast<double>(std::numeric_limits<typename RealOf<T>::type>::min()),
                                          1e-300) *
                                 1e10;

template <class T>
using Point = std::array<T, 3>;

template <class T, class V>
T constant(const V& value) {
  return T(static_cast<typename RealOf<T>::type>(value));
}

inline Point<double> local_point(const Vec3& p, double /*tag*/) { return {p.x(), p.y(), p.z()}; }
inline Point<float> local_point(const Vec3& p, float /*tag*/) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}
inline Point<long double> local_point(const Vec3& p, long double /*tag*/) { return {p.x(), p.y(), p.z()}; }
template <class R>
Point<DualOf<R>> local_point(const Vec3& p, const DualOf<R>& /*tag*/) {
  return {DualOf<R>(p.x(), 1, 0, 0), DualOf<R>(p.y(), 0, 1, 0), DualOf<R>(p.z(), 0, 0, 1)};
}

/// Position of a triangle relative to a point, from e = corner − point, by components in the plane and across it. Edge
/// k lies opposite corner k.
template <class T>
struct Seen {
  std::array<T, 3> along, out;  ///< components of e of each corner along tangent and outward
  std::array<T, 3> r;           ///< distance of each corner from the point
  T h;                          ///< height of the point below the plane: positive inside the cage
  std::array<T, 3> a;           ///< signed distance of the point's projection from each edge's line, positive inside
  std::array<T, 3> c;           ///< distance of the point itself from each edge's line
  std::array<T, 3> begin, end;  ///< positions of each edge's ends along its line, from the point's projection
  double far;                   ///< largest distance of a corner from the point
};

/// `offsets`: corner − point, per corner.
template <class T, class R>
Seen<T> seen(const FaceFrameOf<R>& face, const std::array<Point<T>, 3>& offsets) {
  Seen<T> s;
  const auto dot = [](const Point<T>& e, const std::array<R, 3>& d) {
    return e[0] * constant<T>(d[0]) + e[1] * constant<T>(d[1]) + e[2] * constant<T>(d[2]);
  };
  std::size_t nearest = 0;
  std::array<T, 3> height;
  for (std::size_t k = 0; k < 3; ++k) {
    const Point<T>& e = offsets[k];
    s.r[k] = real::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
    s.along[k] = dot(e, face.tangent);
    s.out[k] = dot(e, face.outward);
    height[k] = dot(e, face.normal);
    if (value_of(s.r[k]) < value_of(s.r[nearest])) nearest = k;
  }
  s.h = height[nearest];
  s.far = std::max({value_of(s.r[0]), value_of(s.r[1]), value_of(s.r[2])});
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    const std::size_t m = value_of(s.r[i]) < value_of(s.r[j]) ? i : j;
    const T nt = constant<T>(face.normal_t[k]), no = constant<T>(face.normal_o[k]);
    const T et = constant<T>(face.edge_t[k]), eo = constant<T>(face.edge_o[k]);
    s.a[k] = s.along[m] * nt + s.out[m] * no;
    s.c[k] = real::sqrt(s.a[k] * s.a[k] + s.h * s.h);
    // On an edge's line, quotients by c have a limit; this value of c reaches it.
    if (value_of(s.c[k]) == 0) s.c[k] = constant<T>(std::sqrt(min_square<T>));
    s.begin[k] = s.along[i] * et + s.out[i] * eo;
    s.end[k] = s.along[j] * et + s.out[j] * eo;
  }
  return s;
}

template <class T>
Seen<T> seen(const CageFrame& cage, const FaceFrame& face, const Point<T>& x) {
  std::array<Point<T>, 3> offsets;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& v = cage.vertices[face.vertices[k]];
    offsets[k] = {constant<T>(v.x()) - x[0], constant<T>(v.y()) - x[1], constant<T>(v.z()) - x[2]};
  }
  return seen(face, offsets);
}

/// Barycentric coordinates of the point's projection; they sum to 1 and reproduce it whatever the triangle's shape.
template <class T, class R>
std::array<T, 3> barycentric(const FaceFrameOf<R>& face, const Seen<T>& s) {
  const T apex = s.a[0] / constant<T>(face.height);
  const T second = -((constant<T>(1) - apex) * s.along[1] + apex * s.along[0]) / constant<T>(face.length);
  return {apex, constant<T>(1) - apex - second, second};
}

/// ∇λᵢ · Σ_k ν_k q_k for each corner, ν_k the edges' outward normals in the plane; sums to 0.
template <class T, class R>
std::array<T, 3> gradients_dot(const FaceFrameOf<R>& face, const std::array<T, 3>& q) {
  T t = constant<T>(0), o = constant<T>(0);
  for (std::size_t k = 0; k < 3; ++k) {
    t += q[k] * constant<T>(face.normal_t[k]);
    o += q[k] * constant<T>(face.normal_o[k]);
  }
  const T apex = -o / constant<T>(face.height);
  const T second = (t - apex * constant<T>(face.apex)) / constant<T>(face.length);
  return {apex, -(apex + second), second};
}

/// Distance of the point's projection from the triangle, 0 inside.
template <class T>
double distance_in_plane(const Seen<T>& s) {
  bool inside = true;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const double a = value_of(s.a[k]), beyond = std::max({0.0, value_of(s.begin[k]), -value_of(s.end[k])});
    inside = inside && a >= 0;
    least = std::min(least, std::hypot(a, beyond));
  }
  return inside ? 0 : least;
}

/// Distance of the point from the triangle as a set, within a factor of √2; 0 on it.
template <class T>
double distance_of(const Seen<T>& s) {
  return std::max(std::abs(value_of(s.h)), distance_in_plane(s));
}

/// Points nearer to the surface than this (local units) count as on it, which is as far as rounding can tell. The same
/// for every face of a cage and for weights and gradients: if faces disagreed about a point, it would be lost.
template <class T>
inline const double surface_tolerance = 8 * epsilon<T>;

enum class Place { off_plane, in_plane, on_face };

/// Position of the point relative to the triangle: on it (interior, edge or corner), in its plane but outside it, or
/// elsewhere.
template <class T>
Place place(const Seen<T>& s) {
  if (distance_of(s) <= surface_tolerance<T>) return Place::on_face;
  return std::abs(value_of(s.h)) <= 4 * epsilon<T> * s.far ? Place::in_plane : Place::off_plane;
}

/// Terms of an edge for a point whose projection lies beyond an end of the edge, near its line. There the closed form
/// is 0 / 0. The angle θ that the edge subtends at the point, divided by the distance c from the line, is a series:
///
///     θ / c = Σ (−1)ⁿ βₙ c²ⁿ / (2n + 1), βₙ = begin⁻²ⁿ⁻¹ − end⁻²ⁿ⁻¹
template <class T>
struct EdgeSeries {
  T quotient;  ///< θ / c
  T slope;     ///< (quotient at c² = a² + h² − quotient at a²) / h²
};
template <class T>
bool is_near_edge_line(const Seen<T>& s, std::size_t k) {
  const double begin = value_of(s.begin[k]), end = value_of(s.end[k]);
  return (begin > 0) == (end > 0) && 7 * value_of(s.c[k]) <= std::min(std::abs(begin), std::abs(end));
}
template <class T, class R>
EdgeSeries<T> edge_series(const FaceFrameOf<R>& face, const Seen<T>& s, std::size_t k) {
  // In units of the distance from the nearer end, so that no power overflows.
  const T unit = constant<T>(1 / std::min(std::abs(value_of(s.begin[k])), std::abs(value_of(s.end[k]))));
  const T a = s.a[k] * unit, h = s.h * unit, aa = a * a, cc = aa + h * h;
  const T u = constant<T>(1) / (s.begin[k] * unit), v = constant<T>(1) / (s.end[k] * unit);
  // βₙ = (u − v) Σ_j uʲ v²ⁿ⁻ʲ, whose terms have one sign.
  const T difference = constant<T>(face.lengths[k]) * unit * u * v;
  const T uu = u * u, vv = v * v;
  T sum = constant<T>(1), v_power = constant<T>(1);  // Σ_j uʲ v²ⁿ⁻ʲ and v²ⁿ
  // Powers of c² and a², and the divided difference of c²ⁿ between c² = a² + h² and a².
  T cc_power = constant<T>(1), aa_power = constant<T>(1), divided = constant<T>(0);
  EdgeSeries<T> series{difference, constant<T>(0)};
  const int terms = static_cast<int>(std::ceil(-std::log2(epsilon<T>) / std::log2(49.0))) + 1;
  for (int n = 1; n <= terms; ++n) {
    sum = sum * uu + v_power * v * (u + v);
    v_power = v_power * vv;
    divided = divided * cc + aa_power;
    cc_power = cc_power * cc;
    aa_power = aa_power * aa;
    const T term = difference * sum * constant<T>((n % 2 == 0 ? 1.0 : -1.0)) / constant<T>(2.0 * n + 1);
    series.quotient += term * cc_power;
    series.slope += term * divided;
  }
  series.quotient = series.quotient * unit;
  series.slope = series.slope * (unit * unit * unit);
  return series;
}

/// h ∫ λᵢ / r⁴ dA per corner by closed form, for a point that is not on the triangle.
template <class T, class R>
std::array<T, 3> mean_value(const FaceFrameOf<R>& face, const Seen<T>& s) {
  std::array<T, 3> angle, q;
  std::array<bool, 3> near_line;
  std::array<T, 3> line_slope;
  for (std::size_t k = 0; k < 3; ++k) {
    near_line[k] = is_near_edge_line(s, k);
    if (near_line[k]) {
      const EdgeSeries<T> series = edge_series(face, s, k);
      q[k] = series.quotient;
      line_slope[k] = series.slope;
      continue;
    }
    angle[k] = real::atan2(T(s.c[k] * constant<T>(face.lengths[k])), T(s.c[k] * s.c[k] + s.begin[k] * s.end[k]));
    q[k] = angle[k] / s.c[k];
  }
  T square = s.h * s.h;
  // In the plane the second form has a limit; this height reaches it.
  if (value_of(square) < min_square<T>) square = constant<T>(min_square<T>);
  T whole = constant<T>(0);
  if (distance_in_plane(s) < 8 * std::abs(value_of(s.h))) {
    for (std::size_t k = 0; k < 3; ++k) whole += s.a[k] * q[k];
    whole = whole / (square + square);
  } else {
    for (std::size_t k = 0; k < 3; ++k) {
      if (near_line[k]) {
        whole += s.a[k] * line_slope[k];
        continue;
      }
      const bool negative = value_of(s.a[k]) < 0;
      if (value_of(s.a[k]) == 0) continue;
      const T a = negative ? T(-s.a[k]) : s.a[k];
      const T sum = s.c[k] + a;
      const auto part = [&](const T& end) { return real::atan(T(square * (end / (sum * (a * s.c[k] + end * end))))); };
      const T term = angle[k] / (s.c[k] * sum) + (part(s.end[k]) - part(s.begin[k])) / square;
      if (negative)
        whole += term;
      else
        whole += -term;
    }
    whole = whole * constant<T>(0.5);
  }
  const std::array<T, 3> lambda = barycentric(face, s), slope = gradients_dot(face, q);
  std::array<T, 3> result;
  for (std::size_t i = 0; i < 3; ++i) result[i] = s.h * (lambda[i] * whole - slope[i] * constant<T>(0.5));
  return result;
}

/// The term of a face that the point lies over or on: h ∫ λᵢ / r⁴ dA = λᵢ / width + restᵢ. The width vanishes with the
/// height, and all three are smooth across the face.
template <class T>
struct OverFace {
  std::array<T, 3> lambda, rest;
  T width;
};
template <class T, class R>
OverFace<T> over_face(const FaceFrameOf<R>& face, const Seen<T>& s) {
  std::array<T, 3> q;
  T sum = constant<T>(0);
  for (std::size_t k = 0; k < 3; ++k) {
    q[k] = real::atan2(T(s.c[k] * constant<T>(face.lengths[k])), T(s.c[k] * s.c[k] + s.begin[k] * s.end[k])) / s.c[k];
    sum += s.a[k] * q[k];
  }
  const std::array<T, 3> slope = gradients_dot(face, q);
  OverFace<T> result{barycentric(face, s), {}, (s.h + s.h) / sum};
  for (std::size_t i = 0; i < 3; ++i) result.rest[i] = s.h * slope[i] * constant<T>(-0.5);
  return result;
}

/// Green's coordinates of one face, times 4π: ∫ λᵢ h / r³ dA per corner and ∫ 1 / r dA.
template <class T>
struct GreenTerms {
  std::array<T, 3> corners;
  T face;
};
template <class T, class R>
GreenTerms<T> green(const FaceFrameOf<R>& face, const Seen<T>& s) {
  std::array<T, 3> logs;
  T sum = constant<T>(0);
  for (std::size_t k = 0; k < 3; ++k) {
    T begin = s.begin[k], end = s.end[k];
    T near = s.r[(k + 1) % 3], far = s.r[(k + 2) % 3];
    if (value_of(begin) + value_of(end) < 0) {
      const T old = begin;
      begin = T(-end);
      end = T(-old);
      std::swap(near, far);
    }
    const T low = value_of(begin) < 0 ? T(s.c[k] * s.c[k] / (near - begin)) : T(begin + near);
    // On the edge itself the integral diverges, but its factor vanishes.
    logs[k] = value_of(low) > 0 ? real::log(T((end + far) / low)) : constant<T>(0);
    sum += s.a[k] * logs[k];
  }
  const auto corner_dot = [&](std::size_t i, std::size_t j) {
    return s.along[i] * s.along[j] + s.out[i] * s.out[j] + s.h * s.h;
  };
  const T product = s.r[0] * s.r[1] * s.r[2];
  const T divisor = product + corner_dot(0, 1) * s.r[2] + corner_dot(1, 2) * s.r[0] + corner_dot(2, 0) * s.r[1];
  T angle = constant<T>(0);
  if (value_of(divisor) > 0.1 * value_of(product)) {
    const T half = real::atan2(T(s.h * constant<T>(face.length * face.height)), divisor);
    angle = half + half;
  } else {
    const bool below = value_of(s.h) < 0;
    const T h = below ? T(-s.h) : s.h;
    for (std::size_t k = 0; k < 3; ++k) {
      const T square = s.c[k] * s.c[k];
      angle += real::atan2(T(s.a[k] * s.end[k]), T(square + h * s.r[(k + 2) % 3])) -
               real::atan2(T(s.a[k] * s.begin[k]), T(square + h * s.r[(k + 1) % 3]));
    }
    if (below) angle = -angle;
    // The solid angle is 0 in the plane beside the triangle, and half of the full angle (2π) on the triangle.
    if (value_of(s.h) == 0 && !(value_of(s.a[0]) > 0 && value_of(s.a[1]) > 0 && value_of(s.a[2]) > 0))
      angle = angle - constant<T>(value_of(angle));
  }
  const std::array<T, 3> lambda = barycentric(face, s), slope = gradients_dot(face, logs);
  GreenTerms<T> result;
  for (std::size_t i = 0; i < 3; ++i) result.corners[i] = lambda[i] * angle - s.h * slope[i];
  result.face = sum - s.h * angle;
  return result;
}

}  // namespace rebake::plane_local
