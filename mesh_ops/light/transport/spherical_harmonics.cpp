#include "mesh_ops/light/transport/spherical_harmonics.h"

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "mesh_ops/base/polar.h"

namespace rebake::sh {

using std::numbers::pi;

Coefficients basis(const Vec3& d) {
  const double x = d.x(), y = d.y(), z = d.z();
  const auto k = [](double numerator, double denominator) { return std::sqrt(numerator / (denominator * pi)); };
  Coefficients b;
  b << k(1, 4), k(3, 4) * y, k(3, 4) * z, k(3, 4) * x,                    // degrees 0 and 1
      k(15, 4) * x * y, k(15, 4) * y * z, k(5, 16) * (3 * z * z - 1),     // degree 2
      k(15, 4) * x * z, k(15, 16) * (x * x - y * y),                      //
      k(35, 32) * y * (3 * x * x - y * y), k(105, 4) * x * y * z,         // degree 3
      k(21, 32) * y * (5 * z * z - 1), k(7, 16) * z * (5 * z * z - 3),    //
      k(21, 32) * x * (5 * z * z - 1), k(105, 16) * z * (x * x - y * y),  //
      k(35, 32) * x * (x * x - 3 * y * y);
  return b;
}

namespace {

template <class Factor>
Coefficients scaled(const Coefficients& c, const Factor& factor) {
  Coefficients result;
  for (int l = 0; l < degrees; ++l)
    for (int k = l * l; k < (l + 1) * (l + 1); ++k) result[k] = factor(l) * c[k];
  return result;
}

}  // namespace

Coefficients convolved_with_cosine(const Coefficients& radiance) {
  return scaled(radiance, [](int l) { return cosine_factors[static_cast<std::size_t>(l)]; });
}

Coefficients clamped_cosine(const Vec3& normal) { return convolved_with_cosine(basis(normal)); }

Coefficients windowed(const Coefficients& c, Window window) {
  return scaled(c, [&](int l) {
    if (l == 0 || window == Window::none) return 1.0;
    const double x = pi * l / degrees;
    return window == Window::hann ? (1 + std::cos(x)) / 2 : std::sin(x) / x;
  });
}

namespace {

// The recurrence of Ivanic and Ruedenberg in their notation: r is the block of degree 1, `below` that of degree l − 1.
class Recurrence {
 public:
  Recurrence(const Eigen::MatrixXd& first, const Eigen::MatrixXd& below, int degree)
      : r_(first), below_(below), l_(degree) {}

  double element(int m, int n) const {
    const int magnitude = std::abs(m);
    const double d = m == 0 ? 1 : 0;
    const double denominator = std::abs(n) == l_ ? 2.0 * l_ * (2 * l_ - 1) : static_cast<double>((l_ + n) * (l_ - n));
    const double u = std::sqrt((l_ + m) * (l_ - m) / denominator);
    const double v = 0.5 * std::sqrt((1 + d) * (l_ + magnitude - 1) * (l_ + magnitude) / denominator) * (1 - 2 * d);
    const double w = -0.5 * std::sqrt((l_ - magnitude - 1) * (l_ - magnitude) / denominator) * (1 - d);
    // Terms with factor 0 are skipped: they would index outside the blocks.
    return (u != 0 ? u * term_u(m, n) : 0) + (v != 0 ? v * term_v(m, n) : 0) + (w != 0 ? w * term_w(m, n) : 0);
  }

 private:
  double first(int m, int n) const { return r_(m + 1, n + 1); }
  double below(int m, int n) const { return below_(m + l_ - 1, n + l_ - 1); }
  double p(int i, int a, int b) const {
    if (b == l_) return first(i, 1) * below(a, l_ - 1) - first(i, -1) * below(a, -l_ + 1);
    if (b == -l_) return first(i, 1) * below(a, -l_ + 1) + first(i, -1) * below(a, l_ - 1);
    return first(i, 0) * below(a, b);
  }
  double term_u(int m, int n) const { return p(0, m, n); }
  double term_v(int m, int n) const {
    if (m == 0) return p(1, 1, n) + p(-1, -1, n);
    if (m > 0) {
      const double d = m == 1 ? 1 : 0;
      return p(1, m - 1, n) * std::sqrt(1 + d) - (m == 1 ? 0 : p(-1, -m + 1, n));
    }
    const double d = m == -1 ? 1 : 0;
    return (m == -1 ? 0 : p(1, m + 1, n)) + p(-1, -m - 1, n) * std::sqrt(1 + d);
  }
  double term_w(int m, int n) const {
    return m > 0 ? p(1, m + 1, n) + p(-1, -m - 1, n) : p(1, m - 1, n) - p(-1, -m + 1, n);
  }

  const Eigen::MatrixXd &r_, &below_;
  int l_;
};

}  // namespace

Rotation::Rotation(const Mat3& turn) {
  const Mat3 t = orthogonal_factor(turn);
  blocks_[0] = Eigen::MatrixXd::Identity(1, 1);
  // Orders −1, 0, 1 are y, z, x.
  constexpr int axis[3] = {1, 2, 0};
  blocks_[1].resize(3, 3);
  for (int m = 0; m < 3; ++m)
    for (int n = 0; n < 3; ++n) blocks_[1](m, n) = t(axis[m], axis[n]);
  for (int l = 2; l < degrees; ++l) {
    Eigen::MatrixXd& block = blocks_[static_cast<std::size_t>(l)];
    block.resize(2 * l + 1, 2 * l + 1);
    const Recurrence recurrence(blocks_[1], blocks_[static_cast<std::size_t>(l - 1)], l);
    for (int m = -l; m <= l; ++m)
      for (int n = -l; n <= l; ++n) block(m + l, n + l) = recurrence.element(m, n);
  }
}

Coefficients Rotation::operator*(const Coefficients& c) const {
  Coefficients result;
  for (int l = 0; l < degrees; ++l)
    result.segment(l * l, 2 * l + 1) = blocks_[static_cast<std::size_t>(l)] * c.segment(l * l, 2 * l + 1);
  return result;
}

}  // namespace rebake::sh
