#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "mesh_ops/deform/cage_frame.h"
#include "mesh_ops/deform/dual.h"

// Integrals over one triangle, in its own plane: no chord of unit vectors, no determinant, no absolute epsilon. T is
// double, float, or Dual for gradients. A point is given in the cage frame. Angles and distances follow the usual
// derivations (Ju et al. 2005 for mean values, Urago 2000 and Lipman et al. 2008 for Green's), arranged so that nothing
// cancels near faces, edges, vertices and planes.

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
inline constexpr double epsilon = static_cast<double>(std::numeric_limits<typename RealOf<T>::type>::epsilon());

/// Far below the square of any height that rounding leaves.
template <class T>
inline constexpr double least_square = static_cast<double>(std::numeric_limits<typename RealOf<T>::type>::min()) * 1e10;

template <class T>
using Point = std::array<T, 3>;

template <class T>
T constant(double value) {
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

/// A triangle as seen from a point: e = corner − point, in the plane and across it.
template <class T>
struct Seen {
  std::array<T, 3> along, out;  ///< of each corner, along the tangent and outward
  std::array<T, 3> r;           ///< its distance
  T h;                          ///< the point's height below the plane: positive inside the cage
  std::array<T, 3> a;           ///< distance of the point's projection from each edge's line, positive inside
  std::array<T, 3> c;           ///< distance of the point itself from it
  std::array<T, 3> begin, end;  ///< the edge's ends along its line, from the point's projection
  double far;                   ///< the largest r
};

template <class T>
Seen<T> seen(const CageFrame& cage, const FaceFrame& face, const Point<T>& x) {
  using std::sqrt;
  Seen<T> s;
  const auto dot = [](const Point<T>& e, const std::array<double, 3>& d) {
    return e[0] * constant<T>(d[0]) + e[1] * constant<T>(d[1]) + e[2] * constant<T>(d[2]);
  };
  std::size_t nearest = 0;
  std::array<T, 3> height;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& v = cage.vertices[face.vertices[k]];
    const Point<T> e{constant<T>(v.x()) - x[0], constant<T>(v.y()) - x[1], constant<T>(v.z()) - x[2]};
    s.r[k] = sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
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
    s.c[k] = sqrt(s.a[k] * s.a[k] + s.h * s.h);
    // On an edge's line what is divided by c has a limit, which this reaches.
    if (value_of(s.c[k]) == 0) s.c[k] = constant<T>(std::sqrt(least_square<T>));
    s.begin[k] = s.along[i] * et + s.out[i] * eo;
    s.end[k] = s.along[j] * et + s.out[j] * eo;
  }
  return s;
}

/// Barycentric coordinates of the point's projection; they sum to 1 and reproduce it whatever the triangle's shape.
template <class T>
std::array<T, 3> barycentric(const FaceFrame& face, const Seen<T>& s) {
  const T apex = s.a[0] / constant<T>(face.height);
  const T second = -((constant<T>(1) - apex) * s.along[1] + apex * s.along[0]) / constant<T>(face.length);
  return {apex, constant<T>(1) - apex - second, second};
}

/// ∇λᵢ · Σ_k ν_k q_k for each corner, ν_k the edges' outward normals in the plane; sums to 0.
template <class T>
std::array<T, 3> gradients_dot(const FaceFrame& face, const std::array<T, 3>& q) {
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

enum class Place { off_plane, in_plane, on_face };

/// Where the point lies as far as rounding can tell.
template <class T>
Place place(const Seen<T>& s) {
  const double tolerance = 4 * epsilon<T> * s.far;
  if (std::abs(value_of(s.h)) > tolerance) return Place::off_plane;
  for (std::size_t k = 0; k < 3; ++k)
    if (value_of(s.a[k]) < -tolerance) return Place::in_plane;
  return Place::on_face;
}

/// h ∫ λᵢ / r⁴ dA for a point that is not on the triangle.
template <class T>
std::array<T, 3> mean_value(const FaceFrame& face, const Seen<T>& s) {
  using std::atan;
  using std::atan2;
  std::array<T, 3> angle, q;
  for (std::size_t k = 0; k < 3; ++k) {
    angle[k] = atan2(s.c[k] * constant<T>(face.lengths[k]), s.c[k] * s.c[k] + s.begin[k] * s.end[k]);
    q[k] = angle[k] / s.c[k];
  }
  T square = s.h * s.h;
  // In the plane the second form has a limit, which this reaches.
  if (value_of(square) < least_square<T>) square = constant<T>(least_square<T>);
  T whole = constant<T>(0);
  if (distance_in_plane(s) < 8 * std::abs(value_of(s.h))) {
    for (std::size_t k = 0; k < 3; ++k) whole += s.a[k] * q[k];
    whole = whole / (square + square);
  } else {
    for (std::size_t k = 0; k < 3; ++k) {
      const bool negative = value_of(s.a[k]) < 0;
      if (value_of(s.a[k]) == 0) continue;  // on the edge's line its part vanishes
      const T a = negative ? -s.a[k] : s.a[k];
      const T sum = s.c[k] + a;
      const auto part = [&](const T& end) { return atan(square * (end / (sum * (a * s.c[k] + end * end)))); };
      const T term = angle[k] / (s.c[k] * sum) + (part(s.end[k]) - part(s.begin[k])) / square;
      whole += negative ? term : -term;
    }
    whole = whole * constant<T>(0.5);
  }
  const std::array<T, 3> lambda = barycentric(face, s), slope = gradients_dot(face, q);
  std::array<T, 3> result;
  for (std::size_t i = 0; i < 3; ++i) result[i] = s.h * (lambda[i] * whole - slope[i] * constant<T>(0.5));
  return result;
}

/// Green's coordinates of one face, times 4π: ∫ λᵢ h / r³ dA for each corner and ∫ 1 / r dA.
template <class T>
struct GreenTerms {
  std::array<T, 3> corners;
  T face;
};
template <class T>
GreenTerms<T> green(const FaceFrame& face, const Seen<T>& s) {
  using std::atan2;
  using std::log;
  std::array<T, 3> logs;
  T sum = constant<T>(0);
  for (std::size_t k = 0; k < 3; ++k) {
    T begin = s.begin[k], end = s.end[k];
    T near = s.r[(k + 1) % 3], far = s.r[(k + 2) % 3];
    if (value_of(begin) + value_of(end) < 0) {
      const T old = begin;
      begin = -end;
      end = -old;
      std::swap(near, far);
    }
    const T low = value_of(begin) < 0 ? s.c[k] * s.c[k] / (near - begin) : begin + near;
    // On the edge itself the integral diverges, but what it is multiplied by vanishes.
    logs[k] = value_of(low) > 0 ? log((end + far) / low) : constant<T>(0);
    sum += s.a[k] * logs[k];
  }
  const auto corner_dot = [&](std::size_t i, std::size_t j) {
    return s.along[i] * s.along[j] + s.out[i] * s.out[j] + s.h * s.h;
  };
  const T product = s.r[0] * s.r[1] * s.r[2];
  const T divisor = product + corner_dot(0, 1) * s.r[2] + corner_dot(1, 2) * s.r[0] + corner_dot(2, 0) * s.r[1];
  T angle = constant<T>(0);
  if (value_of(divisor) > 0.1 * value_of(product)) {
    const T half = atan2(s.h * constant<T>(face.length * face.height), divisor);
    angle = half + half;
  } else {
    const bool below = value_of(s.h) < 0;
    const T h = below ? -s.h : s.h;
    for (std::size_t k = 0; k < 3; ++k) {
      const T square = s.c[k] * s.c[k];
      angle += atan2(s.a[k] * s.end[k], square + h * s.r[(k + 2) % 3]) -
               atan2(s.a[k] * s.begin[k], square + h * s.r[(k + 1) % 3]);
    }
    if (below) angle = -angle;
    if (value_of(s.h) == 0) angle = angle - constant<T>(value_of(angle));  // nothing is seen edge on
  }
  const std::array<T, 3> lambda = barycentric(face, s), slope = gradients_dot(face, logs);
  GreenTerms<T> result;
  for (std::size_t i = 0; i < 3; ++i) result.corners[i] = lambda[i] * angle - s.h * slope[i];
  result.face = sum - s.h * angle;
  return result;
}

}  // namespace rebake::plane_local
