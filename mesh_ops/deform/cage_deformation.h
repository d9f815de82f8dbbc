#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "mesh_ops/deform/coordinates.h"

namespace rebake {

/// What a deformation makes of points.
struct DeformedPoints {
  std::vector<Vec3> points;
  std::vector<Mat3> jacobians;        ///< empty when not asked for
  std::vector<std::uint8_t> outside;  ///< where coordinates hold nothing; such points stay
};

/// Points moved as the cage's vertices went from `rest` to `moved`, in double and without keeping weights: what an edit
/// uses. Points of equal bits move to equal bits, unmoved cages move nothing.
DeformedPoints deform_points(const Coordinates& coordinates, const Cage& rest, const std::vector<Vec3>& moved,
                             const std::vector<Vec3>& points, bool jacobians, const Progress& progress = {});

/// Points bound to a cage once, to be dragged many times: weights computed in double, kept as float. Rotations need
/// gradients, which take three times the memory of the weights.
class CageBinding {
 public:
  CageBinding(const Coordinates& coordinates, const Cage& rest, const std::vector<Vec3>& points, bool gradients,
              const Progress& progress = {});

  /// Where the points are when the cage's vertices are at `moved`. Costs as many rows as move.
  void positions(const std::vector<Vec3>& moved, std::vector<Vec3>& out) const;
  /// Local rotations there; of every `stride`-th point in an order in which neighbours lie side by side, and for those
  /// between the nearest of them, or with `interpolated` between their two neighbours by distance. What either costs in
  /// degrees: `rebake study rotation`. Throws std::logic_error when bound without gradients.
  void rotations(const std::vector<Vec3>& moved, std::vector<Mat3>& out, std::size_t stride = 1,
                 bool interpolated = false) const;

  std::size_t point_count() const { return order_.size(); }
  std::uint64_t memory() const;

 private:
  Cage rest_;
  const Coordinates& coordinates_;
  std::vector<Vec3> points_;
  std::vector<std::uint32_t> order_;  ///< points along a space-filling curve
  std::vector<float> weights_;        ///< a block of batch_lanes points: [row][lane]
  std::vector<float> gradients_;      ///< [row][axis][lane]
};

/// Numbers of the points along a Z-order curve, so that what is processed together lies together.
std::vector<std::uint32_t> curve_order(const std::vector<Vec3>& points);

}  // namespace rebake
