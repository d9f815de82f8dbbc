#pragma once

#include <vector>

#include "mesh_ops/deform/cage_coordinates/coordinates.h"

namespace rebake {

/// Points bound to a cage by cached gradients of their weights, to compute local rotations many times. Gradients are
/// float and take three times the memory of the weights. Used only by `rebake study rotation`, for comparison with the
/// method of edits.
class GradientBinding {
 public:
  /// `coordinates` must outlive this object.
  GradientBinding(const Coordinates& coordinates, const Cage& rest, const std::vector<Vec3>& points);

  /// Local rotations of all points for cage vertices at `moved`. With `stride` > 1, only every stride-th point along a
  /// space-filling curve is computed. The others copy the nearer of their two computed neighbours on the curve or, with
  /// `interpolated`, interpolate both by distance.
  void rotations(const std::vector<Vec3>& moved, std::vector<Mat3>& out, std::size_t stride = 1,
                 bool interpolated = false) const;

 private:
  Cage rest_;
  const Coordinates& coordinates_;
  std::vector<Vec3> points_;
  std::vector<std::uint32_t> order_;  ///< point indices, sorted along a Z-order curve
  std::vector<float> gradients_;      ///< per block of batch_lanes points: [row][axis][lane]
};

}  // namespace rebake
