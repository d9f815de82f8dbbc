#pragma once

#include <Eigen/Dense>
#include <array>

#include "mesh_ops/base/types.h"

namespace rebake {

/// Which file-space direction the decoder is fed.
enum class Axes {
  y_up,     ///< "360": synthetic and unbounded scenes; file-space (x, y, z) is fed as (x, −z, y)
  forward,  ///< forward-facing scenes; fed unchanged
};

/// The orthogonal matrix A with fed direction = A · file-space direction.
Mat3 axes_matrix(Axes axes);

/// The tiny network shared by all texels of an object: 8 features and 3 direction components in, RGB out.
/// Matrices are input-major as in mlp.json: rows are inputs. Hidden widths are free, at least 1.
struct Decoder {
  static constexpr int features = 8;
  static constexpr int inputs = 11;

  Eigen::MatrixXd weights0;  ///< 11 × h0
  Eigen::VectorXd bias0;     ///< h0
  Eigen::MatrixXd weights1;  ///< h0 × h1
  Eigen::VectorXd bias1;     ///< h1
  Eigen::MatrixXd weights2;  ///< h1 × 3
  Eigen::VectorXd bias2;     ///< 3

  int hidden0() const { return static_cast<int>(bias0.size()); }
  int hidden1() const { return static_cast<int>(bias1.size()); }

  /// Equal weights, bit for bit.
  bool operator==(const Decoder& other) const;
};

/// Display colour of averaged features (8) and averaged fed direction. Double precision.
Color decode(const Decoder& decoder, const std::array<double, 8>& features, const Vec3& fed_direction);

/// The decoder that sees direction d as the given one sees `turn`ᵀ · d, in axes `to` instead of `from`
/// (format.md, "View direction under edits": rows 8–10 become A_to · turn · A_from⁻¹ · B).
Decoder fold_turn(const Decoder& decoder, const Mat3& turn, Axes from, Axes to);

}  // namespace rebake
