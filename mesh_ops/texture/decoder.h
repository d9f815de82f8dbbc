#pragma once

#include <Eigen/Dense>
#include <array>

#include "mesh_ops/base/types.h"

namespace rebake {

/// Axis convention of the fed direction: the view direction as the decoder's input.
enum class Axes {
  y_up,     ///< "360": synthetic and unbounded scenes; file-space (x, y, z) is fed as (x, −z, y)
  forward,  ///< forward-facing scenes; fed unchanged
};

/// Orthogonal matrix A with fed direction = A · file-space direction.
Mat3 axes_matrix(Axes axes);

/// How a decoder makes a display colour from features and the network. MobileNeRF has only `network`; the other rules
/// are for objects of other formats. With these, feature 0 of every opaque texel is 1, so that its mean over the
/// samples of a pixel is the covered share: features and direction are divided by it, and features 1 to 3 are the
/// diffuse colour.
enum class ColorRule {
  network,              ///< the network's outputs
  diffuse_and_network,  ///< diffuse colour + the network's outputs, at most 1 (nerf2mesh)
  diffuse,              ///< the diffuse colour; the network is not used (textured meshes)
};

/// MLP shared by all texels of an object: maps 8 features and 3 direction components to RGB, with two hidden ReLU
/// layers and logistic outputs. As in mlp.json, matrix rows are inputs. Hidden widths h0 and h1 are at least 1.
struct Decoder {
  static constexpr int features = 8;
  static constexpr int inputs = 11;

  Eigen::MatrixXd weights0;  ///< 11 × h0
  Eigen::VectorXd bias0;     ///< h0
  Eigen::MatrixXd weights1;  ///< h0 × h1
  Eigen::VectorXd bias1;     ///< h1
  Eigen::MatrixXd weights2;  ///< h1 × 3
  Eigen::VectorXd bias2;     ///< 3
  ColorRule rule = ColorRule::network;

  int hidden0() const { return static_cast<int>(bias0.size()); }
  int hidden1() const { return static_cast<int>(bias1.size()); }

  /// Whether the rules and all widths, weights and biases are equal.
  bool operator==(const Decoder& other) const;
};

/// Display colour for averaged features (8) and an averaged fed direction, in double precision.
Color decode(const Decoder& decoder, const std::array<double, 8>& features, const Vec3& fed_direction);

/// The decoder of objects whose texels hold display colours: ColorRule::diffuse, all weights 0.
Decoder diffuse_decoder();

/// Rotates a decoder: the result maps direction d in axes `to` as `decoder` maps `turn`ᵀ · d in axes `from` (format.md,
/// "View direction under edits": rows 8–10 become A_to · turn · A_from⁻¹ · B).
Decoder fold_rotation(const Decoder& decoder, const Mat3& turn, Axes from, Axes to);

}  // namespace rebake
