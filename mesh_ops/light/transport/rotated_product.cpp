#include "mesh_ops/light/transport/rotated_product.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace rebake {

namespace {

// Axes of zonal harmonics: the first 2l + 1 span the harmonics of degree l, with condition numbers of at most 2.7
// (found by random search).
const std::array<Vec3, 2 * sh::degrees - 1>& lobe_axes() {
  static const std::array<Vec3, 2 * sh::degrees - 1> axes{Vec3(7, 0, -1).normalized(),  Vec3(-1, -5, 4).normalized(),
                                                          Vec3(0, -7, -2).normalized(), Vec3(1, -1, -1).normalized(),
                                                          Vec3(4, -6, 1).normalized(),  Vec3(-3, -6, 1).normalized(),
                                                          Vec3(5, 3, -4).normalized()};
  return axes;
}

}  // namespace

RotatedProduct::RotatedProduct(const std::array<sh::Coefficients, 3>& radiance) {
  for (int l = 0; l < sh::degrees; ++l) {
    const int size = 2 * l + 1;
    Eigen::MatrixXd along(size, size);  // column i: harmonics of degree l along axis i
    for (int i = 0; i < size; ++i)
      along.col(i) = sh::basis(lobe_axes()[static_cast<std::size_t>(i)]).segment(l * l, size);
    const Eigen::PartialPivLU<Eigen::MatrixXd> solver(along);
    for (int c = 0; c < 3; ++c) {
      const Eigen::VectorXd shares = solver.solve(radiance[static_cast<std::size_t>(c)].segment(l * l, size));
      for (int i = 0; i < size; ++i) shares_[static_cast<std::size_t>(i)][static_cast<std::size_t>(l)][c] = shares[i];
    }
  }
}

Radiance RotatedProduct::operator()(const Mat3& turn, const Eigen::Ref<const sh::Coefficients>& transfer) const {
  Radiance sum = Radiance::Zero();
  for (std::size_t i = 0; i < directions; ++i) {
    const sh::Coefficients b = sh::basis(turn.transpose() * lobe_axes()[i]);
    if (i < 1) sum += transfer[0] * b[0] * shares_[i][0];
    if (i < 3) sum += transfer.segment<3>(1).dot(b.segment<3>(1)) * shares_[i][1];
    if (i < 5) sum += transfer.segment<5>(4).dot(b.segment<5>(4)) * shares_[i][2];
    sum += transfer.segment<7>(9).dot(b.segment<7>(9)) * shares_[i][3];
  }
  return sum;
}

std::array<sh::Coefficients, 3> projected_sky(const Light& light, const Mat3& to_light) {
  std::array<sh::Coefficients, 3> result;
  result.fill(sh::Coefficients::Zero());
  // Fibonacci directions over the sphere: more than the sky has texels.
  constexpr int count = 16384;
  constexpr double golden = 0.6180339887498949;
  for (int k = 0; k < count; ++k) {
    const double z = 1 - (2 * k + 1.0) / count, r = std::sqrt(1 - z * z);
    const double phi = 2 * std::numbers::pi * std::fmod(k * golden, 1.0);
    const Vec3 d(r * std::cos(phi), r * std::sin(phi), z);
    const Radiance radiance = light.sky.at(to_light * d) - light.bounce;
    const sh::Coefficients b = sh::basis(d);
    for (int c = 0; c < 3; ++c) result[static_cast<std::size_t>(c)] += 4 * std::numbers::pi / count * radiance[c] * b;
  }
  return result;
}

}  // namespace rebake
