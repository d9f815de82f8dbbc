#pragma once

#include <string>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// A similarity transform: p becomes scale · rotation · (p − center) + center + shift. The centre keeps the rotation of
/// scenes far from the origin exact to rounding of their own size.
struct Similarity {
  Mat3 rotation = Mat3::Identity();
  double scale = 1;
  Vec3 center = Vec3::Zero();
  Vec3 shift = Vec3::Zero();

  Vec3 operator()(const Vec3& p) const { return scale * (rotation * (p - center)) + center + shift; }
  Affine affine() const;
  double degrees() const;  ///< angle of the rotation, 0 … 180
};

/// A fit to point pairs.
struct PairFit {
  Similarity motion;
  std::vector<double> residuals;  ///< distance per pair after the motion
  double rms = 0;                 ///< root mean square of the residuals
  double extent = 0;              ///< root mean square distance of the fixed points from their centre
  /// Width of the points across their longest direction, relative to their length: below 0.05, the rotation about that
  /// direction is uncertain.
  double spread = 0;
};

/// The similarity, or rigid motion without `with_scale`, that takes `from` to `onto` with the least squared residuals
/// (Umeyama 1991). Throws FieldError, for the field "points" or "onto", for fewer than three pairs, lists of different
/// lengths, points that coincide or lie on a line (within 1e-6 of their extent), pairs that fit much better mirrored,
/// and pairs of which two fit much better swapped.
PairFit fit_pairs(const std::vector<Vec3>& from, const std::vector<Vec3>& onto, bool with_scale);

}  // namespace rebake
