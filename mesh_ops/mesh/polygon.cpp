#include "mesh_ops/mesh/polygon.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

// Corners in the plane perpendicular to Newell's normal, around their centre and scaled to size 1; empty if the polygon
// has no area.
std::vector<Vec2> flattened(const std::vector<Vec3>& corners) {
  Box box;
  for (const Vec3& corner : corners) box.extend(corner);
  const double size = box.sizes().maxCoeff();
  if (!(size > 0)) return {};
  std::vector<Vec3> local;
  for (const Vec3& corner : corners) local.push_back((corner - box.center()) / size);
  Vec3 normal = Vec3::Zero();
  for (std::size_t k = 0; k < local.size(); ++k) normal += local[k].cross(local[(k + 1) % local.size()]);
  constexpr double least_area = 1e-12;
  if (!(normal.norm() > least_area)) return {};
  normal.normalize();
  Eigen::Index smallest = 0;
  normal.cwiseAbs().minCoeff(&smallest);
  const Vec3 u = normal.cross(Vec3::Unit(smallest)).normalized(), v = normal.cross(u);
  std::vector<Vec2> flat;
  for (const Vec3& corner : local) flat.emplace_back(corner.dot(u), corner.dot(v));
  return flat;
}

// Twice the signed area of a triangle; 0 within rounding.
double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 ab = b - a, ac = c - a;
  const double area = ab.x() * ac.y() - ab.y() * ac.x();
  constexpr double rounding = 1e-12;
  return std::abs(area) <= rounding ? 0 : area;
}

// Whether two segments have a point in common.
bool touch(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  const auto on = [](const Vec2& p, const Vec2& q, const Vec2& r, double side) {
    return side == 0 && (r - p).dot(r - q) <= 0;
  };
  return on(a, b, c, abc) || on(a, b, d, abd) || on(c, d, a, cda) || on(c, d, b, cdb);
}

bool sides_touch(const std::vector<Vec2>& flat) {
  const std::size_t n = flat.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours
      if (touch(flat[i], flat[i + 1], flat[j], flat[(j + 1) % n])) return true;
    }
  return false;
}

// Whether the sides turn in one direction, and once around.
bool is_convex(const std::vector<Vec2>& flat) {
  const std::size_t n = flat.size();
  std::size_t direction_changes = 0;
  double before = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const Vec2 &a = flat[k], &b = flat[(k + 1) % n], &c = flat[(k + 2) % n];
    if (turn(a, b, c) < 0) return false;
    // A side that turns back lies on the one before.
    if (turn(a, b, c) == 0 && (b - a).dot(c - b) < 0) return false;
    // A convex polygon's sides change between leftward and rightward twice.
    const double x = (b - a).x();
    if (x * before < 0) ++direction_changes;
    if (x != 0) before = x;
  }
  return direction_changes <= 2;
}

std::vector<std::array<std::size_t, 3>> fan(std::size_t corners) {
  std::vector<std::array<std::size_t, 3>> triangles;
  for (std::size_t k = 1; k + 1 < corners; ++k) triangles.push_back({0, k, k + 1});
  return triangles;
}

// Whether the corner at `k` of the remaining polygon can be cut off.
bool is_ear(const std::vector<Vec2>& flat, const std::vector<std::size_t>& left, std::size_t k) {
  const std::size_t n = left.size(), before = left[(k + n - 1) % n], at = left[k], after = left[(k + 1) % n];
  if (turn(flat[before], flat[at], flat[after]) <= 0) return false;
  return std::none_of(left.begin(), left.end(), [&](std::size_t other) {
    return other != before && other != at && other != after && turn(flat[before], flat[at], flat[other]) >= 0 &&
           turn(flat[at], flat[after], flat[other]) >= 0 && turn(flat[after], flat[before], flat[other]) >= 0;
  });
}

// Triangles of a polygon whose sides do not touch; fewer if rounding leaves no ear.
std::vector<std::array<std::size_t, 3>> ears(const std::vector<Vec2>& flat) {
  std::vector<std::size_t> left(flat.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  std::vector<std::array<std::size_t, 3>> triangles;
  while (left.size() > 3) {
    std::size_t k = 0;
    while (k < left.size() && !is_ear(flat, left, k)) ++k;
    if (k == left.size()) break;
    triangles.push_back({left[(k + left.size() - 1) % left.size()], left[k], left[(k + 1) % left.size()]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(k));
  }
  if (left.size() == 3) triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

}  // namespace

CutPolygon cut_polygon(const std::vector<Vec3>& corners) {
  if (corners.size() == 3) return {PolygonShape::convex, fan(3)};
  const std::vector<Vec2> flat = flattened(corners);
  if (flat.empty()) return {PolygonShape::crossing, fan(corners.size())};
  if (is_convex(flat)) return {PolygonShape::convex, fan(corners.size())};
  if (corners.size() > most_concave_corners)
    throw Error(
        fmt::format("a concave polygon has {} corners; at most {} can be cut", corners.size(), most_concave_corners));
  if (sides_touch(flat)) return {PolygonShape::crossing, fan(corners.size())};
  std::vector<std::array<std::size_t, 3>> triangles = ears(flat);
  if (triangles.size() + 2 < corners.size()) return {PolygonShape::crossing, fan(corners.size())};
  return {PolygonShape::concave, std::move(triangles)};
}

}  // namespace rebake
