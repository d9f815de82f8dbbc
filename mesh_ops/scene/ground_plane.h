#pragma once

#include <array>

#include "mesh_ops/base/types.h"

namespace rebake {

/// The ground plane of a scene in world space: points p with normal · p = height. Objects drop onto it and snap to it,
/// the grid is drawn on it, and its normal is the up direction of sky light.
struct Ground {
  Vec3 normal{0, 1, 0};  ///< unit vector, up
  double height = 0;     ///< signed distance from the origin along the normal

  /// Signed height of a point above the plane, in scene units.
  double above(const Vec3& point) const { return normal.dot(point) - height; }
  bool operator==(const Ground&) const = default;
};

/// Rotation whose columns are the ground's x axis, its normal and its z axis: the shortest rotation that takes +y to
/// the normal, for normals above the horizon.
Mat3 ground_frame(const Ground& ground);

/// Smallest height of a box's corners above the plane.
double lowest_above(const Ground& ground, const Box& box);

/// The plane through three points; its normal points to the side of +y (of +x or +z if the plane is vertical).
/// Relative error of normal and height: a few rounding errors times the ratio of the triangle's longest to its shortest
/// height. Throws std::invalid_argument if the points are not finite or lie within 1e-9 of a line, relative to their
/// distances.
Ground ground_through(const std::array<Vec3, 3>& points);

}  // namespace rebake
