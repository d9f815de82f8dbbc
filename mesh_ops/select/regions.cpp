#include "mesh_ops/select/regions.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

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
  extent_ = box.sizes();
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

namespace {

// Doubles in their order, as numbers.
std::int64_t order_of(double value) {
  const auto bits = std::bit_cast<std::int64_t>(value);
  return bits < 0 ? std::numeric_limits<std::int64_t>::min() - bits : bits;
}
double double_of(std::int64_t order) {
  return std::bit_cast<double>(order < 0 ? std::numeric_limits<std::int64_t>::min() - order : order);
}

// The least double for which `holds` is true; it must be true for infinity and for all doubles above one.
template <class Holds>
double least_double(Holds holds) {
  std::int64_t low = order_of(-std::numeric_limits<double>::infinity()),
               high = order_of(std::numeric_limits<double>::infinity());
  if (holds(double_of(low))) return double_of(low);
  const auto between = [&] { return static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low); };
  while (between() > 1) {
    const std::int64_t middle = low + static_cast<std::int64_t>(between() / 2);
    (holds(double_of(middle)) ? high : low) = middle;
  }
  return double_of(high);
}

}  // namespace

std::pair<Affine, Box> box_region_of(const FrameTransform& points, const BoxRegion& box) {
  if (!points.is_relative()) return {points.affine_from_object(), Box(box.min, box.max)};
  // Coordinates grow with the point, so each limit is one double.
  Box limits;
  for (int axis = 0; axis < 3; ++axis) {
    const auto coordinate = [&](double value) { return points.from_object(Vec3(Vec3::Unit(axis) * value))[axis]; };
    limits.min()[axis] = least_double([&](double value) { return coordinate(value) >= box.min[axis]; });
    limits.max()[axis] = -least_double([&](double value) { return coordinate(-value) <= box.max[axis]; });
  }
  return {Affine::Identity(), limits};
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
