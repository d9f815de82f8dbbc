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

/// The part of space that a forward capture's grid divides.
struct Frustum {
  double slope = 0.875;  ///< largest |x| / depth and |y| / depth
  double farthest = 25;  ///< depth, if the nearest is 1
};

/// A grid of side³ cells in the normalised frame of a capture. Cell coordinates are 0 … side per axis. An object and
/// the middle of an unbounded scene fill the cube ±1. A forward capture looks along −z at depths from 1 on; its first
/// two cell coordinates are proportional to x / depth and y / depth, the third to ln(depth) (MobileNeRF, appendix, and
/// its published code). Around the cube of an unbounded scene are nested boxes without top and bottom (z is up).
class GridSpace {
 public:
  GridSpace(CaptureKind kind, int side, int boxes = 0, const Frustum& frustum = {});

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

  /// Distance from the eye below which nothing is hit: 0.2 in unbounded scenes, as published, else 0.
  double nearest() const { return kind_ == CaptureKind::unbounded ? 0.2 : 0; }
  int boxes() const { return boxes_; }
  /// Half the width of a nested box: from 1 to 16, growing exponentially.
  double box_radius(int box) const;
  /// Where a ray leaves the four sides of a box, if it does so through one of them.
  std::optional<double> box_exit(int box, const Vec3& origin, const Vec3& direction) const;

  /// Where the fields are evaluated, in the unit cube, for a point inside the grid and for one on a box.
  Vec3 field_place(const Vec3& cells) const;
  Vec3 box_place(int box, const Vec3& point) const;
  /// Size of the grid in the fields' unit cube: 1, or ½ if there are boxes.
  double field_share() const { return boxes_ > 0 ? 0.5 : 1; }

  Vec3 to_cells(const Vec3& point) const;
  Vec3 from_cells(const Vec3& cells) const;
  /// Derivatives of from_cells(): column i is that by cell coordinate i.
  Mat3 from_cells_slopes(const Vec3& cells) const;
  /// Derivative of to_cells(point + t · direction) by t at t = 0.
  Vec3 cells_along(const Vec3& point, const Vec3& direction) const;

  /// The part t ∈ [first, second], first ≥ 0, of a ray that lies inside the grid. Begins at nearest().
  std::optional<std::pair<double, double>> range_of(const Vec3& origin, const Vec3& direction) const;
  /// Where the ray crosses plane `layer` (0 … side) of an axis along its trend; infinity if it never does.
  double crossing(int axis, int layer, const Vec3& origin, const Vec3& direction) const;
  /// Whether an axis' cell coordinate grows (1), falls (−1) or stays (0) along a ray inside the grid.
  int trend(int axis, const Vec3& origin, const Vec3& direction) const;

 private:
  CaptureKind kind_;
  int side_, boxes_;
  Frustum frustum_;
  std::vector<double> planes_, depths_;  // per layer: position of its plane, and for forward captures its depth
};

}  // namespace rebake
