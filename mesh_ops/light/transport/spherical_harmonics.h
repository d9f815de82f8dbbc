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

/// All basis functions along a unit direction, as polynomials in its components: exact at the poles too.
Coefficients basis(const Vec3& direction);

/// The value of a function along a direction.
inline double value(const Coefficients& c, const Vec3& direction) { return c.dot(basis(direction)); }

/// Factor per degree of the convolution with the clamped cosine divided by π (Ramamoorthi and Hanrahan 2001).
/// Irradiance divided by π about a normal is value(convolved_with_cosine(radiance), normal).
inline constexpr std::array<double, degrees> cosine_factors{1.0, 2.0 / 3, 0.25, 0.0};
Coefficients convolved_with_cosine(const Coefficients& radiance);

/// The clamped cosine about a normal, divided by π: its dot product with radiance is the unshadowed irradiance / π.
Coefficients clamped_cosine(const Vec3& normal);

/// Windows against ringing: a factor per degree, 1 at degree 0 (Sloan 2008).
enum class Window { none, hann, lanczos };
Coefficients windowed(const Coefficients& c, Window window);

/// Rotation of functions: value(rotation · c, turn · d) = value(c, d). Recursive blocks of Ivanic and Ruedenberg (1996,
/// corrected 1998), precise near the identity, where Euler angles are not.
class Rotation {
 public:
  /// The orthogonal polar factor of a matrix (with a reflection if it mirrors). Throws std::invalid_argument if the
  /// matrix is singular.
  explicit Rotation(const Mat3& turn);
  Coefficients operator*(const Coefficients& c) const;
  /// The (2l + 1)×(2l + 1) block of a degree l.
  const Eigen::MatrixXd& block(int degree) const { return blocks_[static_cast<std::size_t>(degree)]; }

 private:
  std::array<Eigen::MatrixXd, degrees> blocks_;
};

}  // namespace sh
}  // namespace rebake
