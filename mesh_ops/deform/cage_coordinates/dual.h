#pragma once

#include <cmath>
#include <type_traits>

#include "mesh_ops/base/elementary.h"

namespace rebake {

/// Elementary functions for each number type. Those of double give the same bits on every processor.
namespace real {
template <class R>
R atan2(const R& y, const R& x) {
  if constexpr (std::is_same_v<R, double>) {
    return elementary::atan2(y, x);
  } else {
    using std::atan2;
    return atan2(y, x);
  }
}
template <class R>
R atan(const R& x) {
  return atan2(x, R(1));
}
template <class R>
R log(const R& x) {
  if constexpr (std::is_same_v<R, double>) {
    return elementary::log(x);
  } else {
    using std::log;
    return log(x);
  }
}
template <class R>
R sqrt(const R& x) {
  using std::sqrt;
  return sqrt(x);
}
}  // namespace real

/// A number `v` with its gradient (x, y, z) in space: forward-mode automatic differentiation.
template <class Real>
struct DualOf {
  Real v = 0, x = 0, y = 0, z = 0;

  DualOf() = default;
  explicit DualOf(Real value) : v(value) {}
  DualOf(Real value, Real dx, Real dy, Real dz) : v(value), x(dx), y(dy), z(dz) {}
};
using Dual = DualOf<double>;
using LongDual = DualOf<long double>;

template <class R>
DualOf<R> operator-(const DualOf<R>& a) {
  return {-a.v, -a.x, -a.y, -a.z};
}
template <class R>
DualOf<R> operator+(const DualOf<R>& a, const DualOf<R>& b) {
  return {a.v + b.v, a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class R>
DualOf<R> operator-(const DualOf<R>& a, const DualOf<R>& b) {
  return {a.v - b.v, a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class R>
DualOf<R> operator*(const DualOf<R>& a, const DualOf<R>& b) {
  return {a.v * b.v, a.x * b.v + a.v * b.x, a.y * b.v + a.v * b.y, a.z * b.v + a.v * b.z};
}
template <class R>
DualOf<R> operator*(R a, const DualOf<R>& b) {
  return {a * b.v, a * b.x, a * b.y, a * b.z};
}
template <class R>
DualOf<R> operator*(const DualOf<R>& a, R b) {
  return b * a;
}
template <class R>
DualOf<R> operator/(const DualOf<R>& a, const DualOf<R>& b) {
  const R quotient = a.v / b.v, inverse = 1 / b.v;
  return {quotient, (a.x - quotient * b.x) * inverse, (a.y - quotient * b.y) * inverse,
          (a.z - quotient * b.z) * inverse};
}
template <class R>
DualOf<R> operator/(const DualOf<R>& a, R b) {
  return {a.v / b, a.x / b, a.y / b, a.z / b};
}
template <class R>
DualOf<R>& operator+=(DualOf<R>& a, const DualOf<R>& b) {
  return a = a + b;
}

/// f(a) by the chain rule: `value` = f(a.v), `slope` = f′(a.v).
template <class R>
DualOf<R> chained(R value, R slope, const DualOf<R>& a) {
  return {value, slope * a.x, slope * a.y, slope * a.z};
}
template <class R>
DualOf<R> sqrt(const DualOf<R>& a) {
  const R root = real::sqrt(a.v);
  return chained(root, root > 0 ? R(R(0.5) / root) : R(0), a);
}
template <class R>
DualOf<R> abs(const DualOf<R>& a) {
  return a.v < 0 ? -a : a;
}
template <class R>
DualOf<R> log(const DualOf<R>& a) {
  return chained(real::log(a.v), R(1 / a.v), a);
}
template <class R>
DualOf<R> atan(const DualOf<R>& a) {
  return chained(real::atan(a.v), R(1 / (1 + a.v * a.v)), a);
}
template <class R>
DualOf<R> atan2(const DualOf<R>& y, const DualOf<R>& x) {
  const R square = x.v * x.v + y.v * y.v;
  const R by_y = square > 0 ? R(x.v / square) : R(0), by_x = square > 0 ? R(-y.v / square) : R(0);
  return {real::atan2(y.v, x.v), by_y * y.x + by_x * x.x, by_y * y.y + by_x * x.y, by_y * y.z + by_x * x.z};
}

namespace real {
template <class R>
DualOf<R> atan2(const DualOf<R>& y, const DualOf<R>& x) {
  return rebake::atan2(y, x);
}
template <class R>
DualOf<R> atan(const DualOf<R>& a) {
  return rebake::atan(a);
}
template <class R>
DualOf<R> log(const DualOf<R>& a) {
  return rebake::log(a);
}
template <class R>
DualOf<R> sqrt(const DualOf<R>& a) {
  return rebake::sqrt(a);
}
}  // namespace real

template <class R>
double value_of(const DualOf<R>& a) {
  return static_cast<double>(a.v);
}
template <class R>
double value_of(const R& a) {
  return static_cast<double>(a);
}

}  // namespace rebake
