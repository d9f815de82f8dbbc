#include "mesh_ops/select/regions.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace rebake {

namespace {

Vec3 centre(const Soup& soup, const Face& face) {
  return (soup.positions()[face[0]] + soup.positions()[face[1]] + soup.positions()[face[2]]) / 3;
}

}  // namespace

FrameTransform::FrameTransform(CoordinateFrame frame, const PlacedNode& placed) {
  if (frame == CoordinateFrame::world) from_object_ = metric_ = placed.to_world;
  if (frame != CoordinateFrame::bounds) return;
  const Box box = placed.node->object->bounds();
  radius_scale_ = box.diagonal().norm();
  for (int axis = 0; axis < 3; ++axis) {
    // If the box is flat along an axis, its only coordinate on that axis maps to 0.
    const double size = box.sizes()[axis];
    const double scale = size > 0 ? 1 / size : 1;
    from_object_.linear()(axis, axis) = scale;
    from_object_.translation()[axis] = -box.min()[axis] * scale;
  }
}

ObjectRegion region_of(const FrameTransform& points, const BoxRegion& box) {
  const Affine& from_object = points.from_object();
  const auto inside = [from_object, box](const Vec3& object_point) {
    const Vec3 p = from_object * object_point;
    return (p.array() >= box.min.array()).all() && (p.array() <= box.max.array()).all();
  };
  const auto may_touch = [from_object, box](const std::array<Vec3, 3>& corners) {
    Box triangle;
    for (const Vec3& corner : corners) triangle.extend(from_object * corner);
    return (triangle.max().array() >= box.min.array()).all() && (triangle.min().array() <= box.max.array()).all();
  };
  return {inside, may_touch};
}

ObjectRegion region_of(const FrameTransform& points, const SphereRegion& sphere) {
  const Vec3 center = points.metric() * points.to_object(sphere.center);
  const double radius = sphere.radius * points.radius_scale();
  const Affine& metric = points.metric();
  const auto inside = [metric, center, radius](const Vec3& object_point) {
    return (metric * object_point - center).norm() <= radius;
  };
  const auto may_touch = [metric, center, radius](const std::array<Vec3, 3>& corners) {
    Box triangle;
    for (const Vec3& corner : corners) triangle.extend(metric * corner);
    return triangle.exteriorDistance(center) <= radius;
  };
  return {inside, may_touch};
}

ObjectRegion region_of(const FrameTransform& points, const HalfSpaceRegion& half) {
  const auto inside = [from_object = points.from_object(), half](const Vec3& object_point) {
    return half.normal.dot(from_object * object_point - half.point) >= 0;
  };
  const auto may_touch = [inside](const std::array<Vec3, 3>& corners) {
    return std::any_of(corners.begin(), corners.end(), inside);
  };
  return {inside, may_touch};
}

TriangleSet triangles_by_centre(const BakedObject& object, const std::function<bool(const Vec3&)>& inside) {
  TriangleSet flags(object.triangle_count(), 0);
  std::size_t first = 0;
  for (const TextureSet& set : object.sets) {
    const Soup& soup = set.soup;
    tbb::parallel_for(std::size_t{0}, soup.triangle_count(),
                      [&](std::size_t f) { flags[first + f] = inside(centre(soup, soup.faces()[f])) ? 1 : 0; });
    first += soup.triangle_count();
  }
  return flags;
}

}  // namespace rebake
