#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "mesh_ops/deform/cage_coordinates/coordinates.h"

namespace rebake {

/// Result of deforming points; one entry per point.
struct DeformedPoints {
  std::vector<Vec3> points;
  std::vector<Mat3> jacobians;        ///< empty if not requested
  std::vector<std::uint8_t> outside;  ///< 1 if the coordinates are undefined there; the point does not move
};

/// Deforms points by moving the cage's vertices from `rest` to `moved`. Computes in double and does not store weights;
/// edits use this. Points that are equal bit for bit stay equal. Points of an unmoved cage keep their bits.
DeformedPoints deform_points(const Coordinates& coordinates, const Cage& rest, const std::vector<Vec3>& moved,
                             const std::vector<Vec3>& points, bool jacobians, const Progress& progress = {});

/// Points bound to a cage once, then dragged many times. Weights are computed in double and stored as float.
class CageBinding {
 public:
  /// `coordinates` must outlive this object.
  CageBinding(const Coordinates& coordinates, const Cage& rest, const std::vector<Vec3>& points,
              const Progress& progress = {});

  /// Positions of the points for cage vertices at `moved`, in the order given. Time is proportional to the number of
  /// moving rows.
  void positions(const std::vector<Vec3>& moved, std::vector<Vec3>& out) const;

  std::size_t point_count() const { return order_.size(); }
  std::uint64_t memory() const;

 private:
  Cage rest_;
  const Coordinates& coordinates_;
  std::vector<Vec3> points_;
  std::vector<std::uint32_t> order_;   ///< point numbers in curve_order()
  std::vector<float> weights_;         ///< [block of batch_lanes points][row][lane]
  std::vector<std::uint8_t> outside_;  ///< per point: 1 if the coordinates are undefined there
};

/// Numbers of the points along a Z-order curve (20 bits per axis), so that consecutive points are close to each other.
std::vector<std::uint32_t> curve_order(const std::vector<Vec3>& points);

}  // namespace rebake
