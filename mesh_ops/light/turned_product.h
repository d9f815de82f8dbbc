#pragma once

#include <array>
#include <cstddef>

#include "mesh_ops/light/spherical_harmonics.h"
#include "mesh_ops/scene/light.h"

namespace rebake {

/// Radiance ready for products with transfer that is turned, without making the turn's matrices: each degree is a sum
/// of zonal harmonics about directions that degrees share, and only those directions are turned (Nowrouzezahrai,
/// Simari and Fiume 2012). Equal to sh::Rotation within 1e-14 of the product's size.
class TurnedProduct {
 public:
  /// Coefficients of red, green and blue.
  explicit TurnedProduct(const std::array<sh::Coefficients, 3>& radiance);
  /// (turn applied to transfer) · radiance, a channel; `turn` is a rotation.
  Radiance operator()(const Mat3& turn, const Eigen::Ref<const sh::Coefficients>& transfer) const;

 private:
  static constexpr std::size_t directions = 2 * sh::degrees - 1;
  std::array<std::array<Radiance, sh::degrees>, directions> shares_{};  ///< [direction][degree]
};

/// The sky's radiance as coefficients, less what hides it sends back: its product with a transfer, and that `bounce`,
/// is irradiance over π to order 4. Without suns, which are too sharp for that. `to_light` turns directions into the
/// light's.
std::array<sh::Coefficients, 3> projected_sky(const Light& light, const Mat3& to_light);

}  // namespace rebake
