#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// Kinds of captures, which differ in the space that the grid divides evenly.
enum class CaptureKind {
  object,     ///< cameras around an object; a cube
  forward,    ///< cameras on one side; a frustum, evenly in direction and in the logarithm of the depth
  unbounded,  ///< cameras amid a scene; a cube, and nested boxes around it
};

/// A grid of side³ cells in the normalised frame of a capture. Cell coordinates are 0 … side per axis. An object and
/// the middle of an unbounded scene fill the cube ±1. A forward capture looks along −z at depths 1 … 25; its first two
/// cell coordinates are proportional to x / depth and y / depth, within ±0.875, the third to ln(depth) (MobileNeRF,
/// appendix, and its published code).
class GridSpace {
 public:
  GridSpace(CaptureKind kind, int side);

  CaptureKind kind() const { return kind_; }
  int side() const { return side_; }
  std::size_t cell_count() const {
    return static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_);
  }
  /// Number of a cell, 0 … cell_count() − 1. No coordinate may be out of range.
  std::uint32_t cell_number(int x, int y, int z) const {
    return static_cast<std::uint32_t>((z * side_ + y) * side_ + x);
  }
  std::array<int, 3> cell_of_number(std::uint32_t cell) const;

  Vec3 to_cells(const Vec3& point) const;
  Vec3 from_cells(const Vec3& cells) const;
  /// Derivatives of from_cells(): column i is that by cell coordinate i.
  Mat3 from_cells_slopes(const Vec3& cells) const;
  /// Derivative of to_cells(point + t · direction) by t at t = 0.
  Vec3 cells_along(const Vec3& point, const Vec3& direction) const;

  /// The part t ∈ [first, second], first ≥ 0, of a ray that lies inside the grid.
  std::optional<std::pair<double, double>> range_of(const Vec3& origin, const Vec3& direction) const;
  /// Where the ray crosses plane `layer` (0 … side) of an axis along its trend; infinity if it never does.
  double crossing(int axis, int layer, const Vec3& origin, const Vec3& direction) const;
  /// Whether an axis' cell coordinate grows (1), falls (−1) or stays (0) along a ray inside the grid.
  int trend(int axis, const Vec3& origin, const Vec3& direction) const;

 private:
  CaptureKind kind_;
  int side_;
  std::vector<double> planes_, depths_;  // per layer: position of its plane, and for forward captures its depth
};

}  // namespace rebake
