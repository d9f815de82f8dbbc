#pragma once

#include <array>
#include <cstddef>

#include "mesh_ops/light/transport/spherical_harmonics.h"
#include "mesh_ops/scene/scene_light.h"

namespace rebake {

/// Radiance in a form for dot products with rotated transfer that needs no rotation matrices: each degree is a sum of
/// zonal harmonics about shared directions, and only these are rotated (Nowrouzezahrai, Simari and Fiume 2012). Equal
/// to sh::Rotation within a relative error of 1e-14.
class RotatedProduct {
 public:
  /// `radiance`: coefficients of red, green and blue.
  explicit RotatedProduct(const std::array<sh::Coefficients, 3>& radiance);
  /// (turn applied to transfer) · radiance, per channel; `turn` is a rotation.
  Radiance operator()(const Mat3& turn, const Eigen::Ref<const sh::Coefficients>& transfer) const;

 private:
  static constexpr std::size_t directions = 2 * sh::degrees - 1;
  std::array<std::array<Radiance, sh::degrees>, directions> shares_{};  ///< [direction][degree]
};

/// Coefficients of the sky's radiance minus the radiance reflected by occluders: the dot product with a transfer, plus
/// `bounce`, is irradiance / π to order 4. Without suns, which are too sharp for that. `to_light` rotates directions
/// into the light's space.
std::array<sh::Coefficients, 3> projected_sky(const Light& light, const Mat3& to_light);

}  // namespace rebake
