#pragma once

#include "editor/fields/fields.h"
#include "mesh_ops/select/region.h"

namespace rebake {

/// Turns object coordinates into those that a selection's numbers are given in, and back.
class FramePoints {
 public:
  FramePoints(CoordinateFrame frame, const PlacedNode& placed);
  const Affine& from_object() const { return from_object_; }
  Vec3 to_object(const Vec3& point) const { return from_object_.inverse() * point; }
  /// What a radius is multiplied by, to be compared with distances in metric().
  double radius_scale() const { return radius_scale_; }
  /// Coordinates in which distances mean something: world, or the object's own.
  const Affine& metric() const { return metric_; }

 private:
  Affine from_object_ = Affine::Identity();
  Affine metric_ = Affine::Identity();
  double radius_scale_ = 1;
};

inline FramePoints::FramePoints(CoordinateFrame frame, const PlacedNode& placed) {
  if (frame == CoordinateFrame::world) from_object_ = metric_ = placed.to_world;
  if (frame != CoordinateFrame::bounds) return;
  const Box box = placed.node->object->bounds();
  radius_scale_ = box.diagonal().norm();
  for (int axis = 0; axis < 3; ++axis) {
    // A flat box has a single coordinate along its flat side; it counts as 0.
    const double size = box.sizes()[axis];
    const double scale = size > 0 ? 1 / size : 1;
    from_object_.linear()(axis, axis) = scale;
    from_object_.translation()[axis] = -box.min()[axis] * scale;
  }
}

inline TriangleSet triangles_inside(const BakedObject& object, const FramePoints& points, const BoxRegion& box) {
  return triangles_by_centre(object, points.from_object(), [&](const Vec3& p) {
    return (p.array() >= box.min.array()).all() && (p.array() <= box.max.array()).all();
  });
}

inline TriangleSet triangles_inside(const BakedObject& object, const FramePoints& points, const SphereRegion& sphere) {
  const Vec3 center = points.metric() * points.to_object(sphere.center);
  const double radius = sphere.radius * points.radius_scale();
  return triangles_by_centre(object, points.metric(), [&](const Vec3& p) { return (p - center).norm() <= radius; });
}

inline TriangleSet triangles_inside(const BakedObject& object, const FramePoints& points, const HalfSpaceRegion& half) {
  return triangles_by_centre(object, points.from_object(),
                             [&](const Vec3& p) { return half.normal.dot(p - half.point) >= 0; });
}

}  // namespace rebake
