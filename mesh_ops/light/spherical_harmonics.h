#pragma once

#include <Eigen/Dense>
#include <array>

#include "mesh_ops/base/types.h"

namespace rebake {

/// Real spherical harmonics, orthonormal, without the Condon–Shortley phase; coefficient l(l + 1) + m of degree l and
/// order −l ≤ m ≤ l. z is the polar axis.
namespace sh {

inline constexpr int degrees = 4;                ///< 0 … 3
inline constexpr int count = degrees * degrees;  ///< coefficients
using Coefficients = Eigen::Matrix<double, count, 1>;

/// All of them along a direction of length 1. Polynomials in its components: exact at the poles, too.
Coefficients basis(const Vec3& direction);

/// The value along a direction.
inline double value(const Coefficients& c, const Vec3& direction) { return c.dot(basis(direction)); }

/// What a convolution with the clamped cosine over π multiplies each degree by (Ramamoorthi and Hanrahan 2001):
/// irradiance over π about a normal is value(cosine_lobe ∘ radiance, normal).
inline constexpr std::array<double, degrees> cosine_factors{1.0, 2.0 / 3, 0.25, 0.0};
Coefficients convolved_with_cosine(const Coefficients& radiance);

/// The clamped cosine about a normal, over π: its product with radiance is irradiance over π without shadows.
Coefficients clamped_cosine(const Vec3& normal);

/// Windows against ringing: factors of each degree, 1 at degree 0 (Sloan 2008).
enum class Window { none, hann, lanczos };
Coefficients windowed(const Coefficients& c, Window window);

/// Turns functions: value(rotation · c, turn · d) = value(c, d). Blocks of Ivanic and Ruedenberg (1996, with the
/// correction of 1998), each of which follows from the one before: precise near the identity, where angles are not.
class Rotation {
 public:
  /// Of the nearest rotation to a matrix, by its polar factor; a mirroring one turns and mirrors. Throws
  /// std::invalid_argument where it is singular.
  explicit Rotation(const Mat3& turn);
  Coefficients operator*(const Coefficients& c) const;
  /// (2l + 1)² of a degree.
  const Eigen::MatrixXd& block(int degree) const { return blocks_[static_cast<std::size_t>(degree)]; }

 private:
  std::array<Eigen::MatrixXd, degrees> blocks_;
};

}  // namespace sh
}  // namespace rebake
