#include "mesh_ops/rays/scene_rays.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rebake {

namespace {

// Largest number of instances in a leaf of the sphere hierarchy.
constexpr std::uint32_t few = 4;

}  // namespace

SceneRays::SceneRays(std::vector<Instance> instances) {
  for (Instance& instance : instances) {
    const Box box = instance.tree->bounds();
    BoundingSphere ball{instance.to_world * box.center(), 0};
    for (const auto corner : {Box::BottomLeftFloor, Box::BottomRightFloor, Box::TopLeftFloor, Box::TopRightFloor,
                              Box::BottomLeftCeil, Box::BottomRightCeil, Box::TopLeftCeil, Box::TopRightCeil})
      ball.radius = std::max(ball.radius, (instance.to_world * box.corner(corner) - ball.middle).norm());
    placed_.push_back({std::move(instance.tree), instance.to_world.inverse(), instance.size, instance.reach, ball});
  }
  order_.resize(placed_.size());
  std::iota(order_.begin(), order_.end(), 0U);
  if (!order_.empty()) grow(0, static_cast<std::uint32_t>(order_.size()));
}

void SceneRays::grow(std::uint32_t first, std::uint32_t end) {
  const auto ball = [&](std::uint32_t k) -> const BoundingSphere& { return placed_[order_[k]].ball; };
  Box middles;
  for (std::uint32_t k = first; k < end; ++k) middles.extend(ball(k).middle);
  Branch branch{{middles.center(), 0}, first, end, 0};
  bool numbers = true;
  for (std::uint32_t k = first; k < end; ++k) {
    // Slightly enlarged to cover rounding.
    const double reached = ((ball(k).middle - branch.ball.middle).norm() + ball(k).radius) * (1 + 1e-12);
    branch.ball.radius = std::max(branch.ball.radius, reached);
    numbers = numbers && std::isfinite(reached);
  }
  const std::size_t number = branches_.size();
  branches_.push_back(branch);
  // Spheres that are not finite cannot be sorted.
  if (end - first <= few || !numbers) return;
  int axis = 0;
  middles.sizes().maxCoeff(&axis);
  const std::uint32_t half = first + (end - first) / 2;
  std::nth_element(
      order_.begin() + first, order_.begin() + half, order_.begin() + end,
      [&](std::uint32_t a, std::uint32_t b) { return placed_[a].ball.middle[axis] < placed_[b].ball.middle[axis]; });
  grow(first, half);
  branches_[number].second = static_cast<std::uint32_t>(branches_.size());
  grow(half, end);
}

bool SceneRays::BoundingSphere::missed_by(const Vec3& origin, const Vec3& direction) const {
  // Adds 1e-12 of the squared distance, far more than its rounding error. With NaN the result is false.
  const Vec3 to_middle = middle - origin;
  const double along = to_middle.dot(direction), squared = to_middle.squaredNorm(), length = direction.squaredNorm(),
               reached = radius * radius + 1e-12 * squared;
  return squared > reached && (along < 0 || (squared - reached) * length > along * along);
}

template <class Visit>
bool SceneRays::any_near(const Vec3& origin, const Vec3& direction, Visit visit) const {
  if (branches_.empty()) return false;
  // Halves differ in size by at most one, so 32 levels suffice for all 32-bit numbers.
  std::array<std::uint32_t, 33> waiting;
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const std::uint32_t number = waiting[--count];
    const Branch& branch = branches_[number];
    if (number > 0 && branch.ball.missed_by(origin, direction)) continue;
    if (branch.second != 0) {
      waiting[count++] = branch.second;
      waiting[count++] = number + 1;
      continue;
    }
    for (std::uint32_t k = branch.first; k < branch.end; ++k)
      if (!placed_[order_[k]].ball.missed_by(origin, direction) && visit(order_[k])) return true;
  }
  return false;
}

std::optional<SceneRays::Hit> SceneRays::nearest(const Vec3& origin, const Vec3& direction, double near,
                                                 double far) const {
  std::optional<Hit> nearest;
  const auto ask = [&](std::size_t k) {
    const Affine& to_object = placed_[k].to_object;
    const auto hit = placed_[k].tree->nearest(to_object * origin, to_object.linear() * direction, near, far);
    if (!hit || hit->t > far) return;
    if (nearest && hit->t == nearest->t && k < nearest->instance) return;
    far = hit->t;
    nearest = Hit{*hit, k};
  };
  if (near >= 0) {
    any_near(origin, direction, [&](std::uint32_t k) {
      ask(k);
      return false;
    });
  } else {
    for (std::size_t k = 0; k < placed_.size(); ++k) ask(k);
  }
  return nearest;
}

void SceneRays::nearest(Bundle& rays, double near) const {
  RayTree::Bundle local;
  local.far = rays.far;
  for (std::size_t k = 0; k < placed_.size(); ++k) {
    const Affine& to_object = placed_[k].to_object;
    bool any = near < 0;
    for (std::size_t ray = 0; ray < 8 && !any; ++ray)
      any = rays.far[ray] >= near && !placed_[k].ball.missed_by(rays.origins[ray], rays.directions[ray]);
    if (!any) continue;
    for (std::size_t ray = 0; ray < 8; ++ray) {
      local.origins[ray] = to_object * rays.origins[ray];
      local.directions[ray] = to_object.linear() * rays.directions[ray];
    }
    placed_[k].tree->nearest(local, near);
    for (std::size_t ray = 0; ray < 8; ++ray)
      if (local.hit[ray]) rays.hits[ray] = Hit{{local.far[ray], local.triangle[ray]}, k};
  }
  rays.far = local.far;
}

bool SceneRays::blocked(const Vec3& from, const Vec3& to) const {
  return any_near(from, to - from, [&](std::uint32_t k) {
    const Placed& placed = placed_[k];
    const Vec3 start = placed.to_object * from, way = placed.to_object * to - start;
    const double distance = way.norm();
    constexpr double rounding = 1e-5;  // relative to the object's size; ten times the tree's error
    return distance > 0 && placed.tree->blocked(start, way, 0, 1 - rounding * std::max(1.0, placed.size / distance));
  });
}

bool SceneRays::shaded(const Vec3& from, const Vec3& direction) const {
  return any_near(from, direction, [&](std::uint32_t k) {
    const Placed& placed = placed_[k];
    return placed.tree->blocked(placed.to_object * from, placed.to_object.linear() * direction, 0, placed.reach);
  });
}

}  // namespace rebake
