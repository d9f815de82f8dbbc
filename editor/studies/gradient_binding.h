#pragma once

#include <vector>

#include "mesh_ops/deform/coordinates.h"

namespace rebake {

/// Gradients of a cage's weights kept as float, to be turned into local rotations many times: three times the memory of
/// the weights, to compare with what edits do (`rebake study rotation`).
class GradientBinding {
 public:
  GradientBinding(const Coordinates& coordinates, const Cage& rest, const std::vector<Vec3>& points);

  /// Local rotations when the cage's vertices are at `moved`; of every `stride`-th point in an order in which
  /// neighbours lie side by side, and for those between the nearest of them, or with `interpolated` between their two
  /// neighbours by distance.
  void rotations(const std::vector<Vec3>& moved, std::vector<Mat3>& out, std::size_t stride = 1,
                 bool interpolated = false) const;

 private:
  Cage rest_;
  const Coordinates& coordinates_;
  std::vector<Vec3> points_;
  std::vector<std::uint32_t> order_;  ///< points along a space-filling curve
  std::vector<float> gradients_;      ///< [row][axis][lane]
};

}  // namespace rebake
