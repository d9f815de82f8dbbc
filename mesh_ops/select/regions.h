#pragma once

#include <array>
#include <functional>
#include <utility>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Coordinate frame of a region. world: world space; node: object space; bounds: relative to the object's bounding box,
/// 0 … 1 per axis.
enum class CoordinateFrame { world, node, bounds };

/// Axis-aligned box, including its boundary.
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

/// Converts between object space and the coordinate frame of a region.
class FrameTransform {
 public:
  FrameTransform(CoordinateFrame frame, const PlacedNode& placed);
  /// A point of object space in the frame. In `bounds`, corners of the box are exactly 0 and 1.
  Vec3 from_object(const Vec3& point) const {
    return relative_ ? Vec3((point - min_).cwiseQuotient(size_)) : Vec3(from_object_ * point);
  }
  /// The other way round. In `bounds`, all coordinates are one where the box is flat.
  Vec3 to_object(const Vec3& point) const {
    return relative_ ? Vec3(min_ + point.cwiseProduct(extent_)) : Vec3(from_object_.inverse() * point);
  }
  /// Factor from a radius in the frame to a distance in the space of metric().
  double radius_scale() const { return radius_scale_; }
  /// Whether coordinates are relative to the object's box; else from_object() is affine_from_object().
  bool is_relative() const { return relative_; }
  const Affine& affine_from_object() const { return from_object_; }
  /// Transform from object space to the space in which distances are measured: world space, or object space itself.
  const Affine& metric() const { return metric_; }

 private:
  Affine from_object_ = Affine::Identity();
  bool relative_ = false;  ///< CoordinateFrame::bounds
  Vec3 min_ = Vec3::Zero(), size_ = Vec3::Ones(), extent_ = Vec3::Ones();
  Affine metric_ = Affine::Identity();
  double radius_scale_ = 1;
};

/// A region of an object, as functions of points in object space.
struct ObjectRegion {
  std::function<bool(const Vec3&)> inside;
  /// Conservative: false only if the triangle with these corners lies entirely outside.
  std::function<bool(const std::array<Vec3, 3>&)> may_touch;
};

/// The region's functions are thread-safe.
ObjectRegion region_of(const FrameTransform& points, const BoxRegion& box);
ObjectRegion region_of(const FrameTransform& points, const SphereRegion& sphere);
ObjectRegion region_of(const FrameTransform& points, const HalfSpaceRegion& half);

/// A map from object space and a box such that the mapped point is in the box if, and only if, region_of(points, box)
/// has the point inside, with the same rounding.
std::pair<Affine, Box> box_region_of(const FrameTransform& points, const BoxRegion& box);

/// Triangles whose centroid in object space is inside. `inside` is called from several threads at once.
TriangleSet triangles_by_centre(const BakedObject& object, const std::function<bool(const Vec3&)>& inside);

}  // namespace rebake
