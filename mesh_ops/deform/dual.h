#pragma once

#include <cmath>

namespace rebake {

/// A number with its gradient in space (forward-mode automatic differentiation).
struct Dual {
  double v = 0, x = 0, y = 0, z = 0;

  Dual() = default;
  explicit Dual(double value) : v(value) {}
  Dual(double value, double dx, double dy, double dz) : v(value), x(dx), y(dy), z(dz) {}
};

inline Dual operator-(const Dual& a) { return {-a.v, -a.x, -a.y, -a.z}; }
inline Dual operator+(const Dual& a, const Dual& b) { return {a.v + b.v, a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Dual operator-(const Dual& a, const Dual& b) { return {a.v - b.v, a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Dual operator*(const Dual& a, const Dual& b) {
  return {a.v * b.v, a.x * b.v + a.v * b.x, a.y * b.v + a.v * b.y, a.z * b.v + a.v * b.z};
}
inline Dual operator*(double a, const Dual& b) { return {a * b.v, a * b.x, a * b.y, a * b.z}; }
inline Dual operator*(const Dual& a, double b) { return b * a; }
inline Dual operator/(const Dual& a, const Dual& b) {
  const double quotient = a.v / b.v, inverse = 1 / b.v;
  return {quotient, (a.x - quotient * b.x) * inverse, (a.y - quotient * b.y) * inverse,
          (a.z - quotient * b.z) * inverse};
}
inline Dual operator/(const Dual& a, double b) { return {a.v / b, a.x / b, a.y / b, a.z / b}; }
inline Dual& operator+=(Dual& a, const Dual& b) { return a = a + b; }

/// f(a), where the derivative of f there is `slope`.
inline Dual chained(double value, double slope, const Dual& a) {
  return {value, slope * a.x, slope * a.y, slope * a.z};
}
inline Dual sqrt(const Dual& a) {
  const double root = std::sqrt(a.v);
  return chained(root, root > 0 ? 0.5 / root : 0.0, a);
}
inline Dual abs(const Dual& a) { return a.v < 0 ? -a : a; }
inline Dual log(const Dual& a) { return chained(std::log(a.v), 1 / a.v, a); }
inline Dual atan(const Dual& a) { return chained(std::atan(a.v), 1 / (1 + a.v * a.v), a); }
inline Dual atan2(const Dual& y, const Dual& x) {
  const double square = x.v * x.v + y.v * y.v;
  const double by_y = square > 0 ? x.v / square : 0, by_x = square > 0 ? -y.v / square : 0;
  return {std::atan2(y.v, x.v), by_y * y.x + by_x * x.x, by_y * y.y + by_x * x.y, by_y * y.z + by_x * x.z};
}

inline double value_of(const Dual& a) { return a.v; }
inline double value_of(double a) { return a; }
inline double value_of(long double a) { return static_cast<double>(a); }
inline double value_of(float a) { return static_cast<double>(a); }

}  // namespace rebake
