#include "mesh_ops/select/regions.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace rebake {

namespace {

// The centroid, which rounding does not move out of the triangle's box.
Vec3 centre(const Soup& soup, const Face& face) {
  const Vec3 &a = soup.positions()[face[0]], &b = soup.positions()[face[1]], &c = soup.positions()[face[2]];
  return ((a + b + c) / 3).cwiseMax(a.cwiseMin(b).cwiseMin(c)).cwiseMin(a.cwiseMax(b).cwiseMax(c));
}

}  // namespace

FrameTransform::FrameTransform(CoordinateFrame frame, const PlacedNode& placed) {
  if (frame == CoordinateFrame::world) from_object_ = metric_ = placed.to_world;
  if (frame != CoordinateFrame::bounds) return;
  const Box box = placed.node->object->bounds();
  radius_scale_ = box.diagonal().norm();
  relative_ = true;
  min_ = box.min();
  // If the box is flat along an axis, its only coordinate on that axis maps to 0.
  size_ = (box.sizes().array() > 0).select(box.sizes(), Vec3::Ones());
  from_object_ = size_.cwiseInverse().asDiagonal() * Eigen::Translation3d(-min_);
}

ObjectRegion region_of(const FrameTransform& points, const BoxRegion& box) {
  const auto inside = [points, box](const Vec3& object_point) {
    const Vec3 p = points.from_object(object_point);
    return (p.array() >= box.min.array()).all() && (p.array() <= box.max.array()).all();
  };
  const auto may_touch = [points, box](const std::array<Vec3, 3>& corners) {
    Box triangle;
    for (const Vec3& corner : corners) triangle.extend(points.from_object(corner));
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
  const auto inside = [points, half](const Vec3& object_point) {
    return half.normal.dot(points.from_object(object_point) - half.point) >= 0;
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
