#pragma once

#include <cmath>

namespace rebake {

/// A number with its gradient in space (forward-mode automatic differentiation).
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

/// f(a), where the derivative of f there is `slope`.
template <class R>
DualOf<R> chained(R value, R slope, const DualOf<R>& a) {
  return {value, slope * a.x, slope * a.y, slope * a.z};
}
template <class R>
DualOf<R> sqrt(const DualOf<R>& a) {
  const R root = std::sqrt(a.v);
  return chained(root, root > 0 ? 0.5 / root : 0.0, a);
}
template <class R>
DualOf<R> abs(const DualOf<R>& a) {
  return a.v < 0 ? -a : a;
}
template <class R>
DualOf<R> log(const DualOf<R>& a) {
  return chained(std::log(a.v), 1 / a.v, a);
}
template <class R>
DualOf<R> atan(const DualOf<R>& a) {
  return chained(std::atan(a.v), 1 / (1 + a.v * a.v), a);
}
template <class R>
DualOf<R> atan2(const DualOf<R>& y, const DualOf<R>& x) {
  const R square = x.v * x.v + y.v * y.v;
  const R by_y = square > 0 ? x.v / square : 0, by_x = square > 0 ? -y.v / square : 0;
  return {std::atan2(y.v, x.v), by_y * y.x + by_x * x.x, by_y * y.y + by_x * x.y, by_y * y.z + by_x * x.z};
}

template <class R>
double value_of(const DualOf<R>& a) {
  return static_cast<double>(a.v);
}
inline double value_of(double a) { return a; }
inline double value_of(long double a) { return static_cast<double>(a); }
inline double value_of(float a) { return static_cast<double>(a); }

}  // namespace rebake
