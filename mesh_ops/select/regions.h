#pragma once

#include <array>
#include <functional>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// What a region's numbers are given in: world; node: the object's own coordinates; bounds: shares of its box.
enum class CoordinateFrame { world, node, bounds };

/// Both ends included.
struct BoxRegion {
  Vec3 min, max;
};
struct SphereRegion {
  Vec3 center;
  double radius = 0;
};
/// Points x with normal · (x − point) ≥ 0.
struct HalfSpaceRegion {
  Vec3 point, normal;
};

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

/// A region of an object, in object space.
struct ObjectRegion {
  std::function<bool(const Vec3&)> inside;
  /// False only where the triangle between the corners lies outside altogether.
  std::function<bool(const std::array<Vec3, 3>&)> may_touch;
};

/// Callable from any thread.
ObjectRegion region_of(const FramePoints& points, const BoxRegion& box);
ObjectRegion region_of(const FramePoints& points, const SphereRegion& sphere);
ObjectRegion region_of(const FramePoints& points, const HalfSpaceRegion& half);

/// Triangles whose centre, in object space, is inside. `inside` is called from several threads.
TriangleSet triangles_by_centre(const BakedObject& object, const std::function<bool(const Vec3&)>& inside);

}  // namespace rebake
