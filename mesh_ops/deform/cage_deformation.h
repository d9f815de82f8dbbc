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

/// Points bound to a cage once, to be dragged many times: weights computed in double, kept as float.
class CageBinding {
 public:
  CageBinding(const Coordinates& coordinates, const Cage& rest, const std::vector<Vec3>& points,
              const Progress& progress = {});

  /// Where the points are when the cage's vertices are at `moved`. Costs as many rows as move.
  void positions(const std::vector<Vec3>& moved, std::vector<Vec3>& out) const;

  std::size_t point_count() const { return order_.size(); }
  std::uint64_t memory() const;

 private:
  Cage rest_;
  const Coordinates& coordinates_;
  std::vector<Vec3> points_;
  std::vector<std::uint32_t> order_;   ///< points along a space-filling curve
  std::vector<float> weights_;         ///< a block of batch_lanes points: [row][lane]
  std::vector<std::uint8_t> outside_;  ///< a flag a point: it stays
};

/// Numbers of the points along a Z-order curve, so that what is processed together lies together.
std::vector<std::uint32_t> curve_order(const std::vector<Vec3>& points);

}  // namespace rebake
