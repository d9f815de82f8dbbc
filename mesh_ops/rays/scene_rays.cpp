#include "mesh_ops/rays/scene_rays.h"

#include <algorithm>

namespace rebake {

SceneRays::SceneRays(std::vector<Instance> instances) {
  for (Instance& instance : instances) {
    const Box box = instance.tree->bounds();
    const Vec3 middle = instance.to_world * box.center();
    double radius = 0;
    for (const auto corner : {Box::BottomLeftFloor, Box::BottomRightFloor, Box::TopLeftFloor, Box::TopRightFloor,
                              Box::BottomLeftCeil, Box::BottomRightCeil, Box::TopLeftCeil, Box::TopRightCeil})
      radius = std::max(radius, (instance.to_world * box.corner(corner) - middle).norm());
    placed_.push_back(
        {std::move(instance.tree), instance.to_world.inverse(), instance.size, instance.reach, middle, radius});
  }
}

bool SceneRays::Placed::passed_by(const Vec3& origin, const Vec3& direction) const {
  // Squares of long distances are rounded: 1e-12 of them is far more. What is no number passes nothing by.
  const Vec3 to_middle = middle - origin;
  const double along = to_middle.dot(direction), squared = to_middle.squaredNorm(), length = direction.squaredNorm(),
               reached = radius * radius + 1e-12 * squared;
  return squared > reached && (along < 0 || (squared - reached) * length > along * along);
}

std::optional<SceneRays::Hit> SceneRays::nearest(const Vec3& origin, const Vec3& direction, double near,
                                                 double far) const {
  std::optional<Hit> nearest;
  for (std::size_t k = 0; k < placed_.size(); ++k) {
    if (near >= 0 && placed_[k].passed_by(origin, direction)) continue;
    const Affine& to_object = placed_[k].to_object;
    const auto hit = placed_[k].tree->nearest(to_object * origin, to_object.linear() * direction, near, far);
    if (!hit || hit->t > far) continue;
    far = hit->t;
    nearest = Hit{hit->t, k, hit->triangle};
  }
  return nearest;
}

void SceneRays::nearest(Bundle& rays, double near) const {
  RayTree::Bundle local;
  local.far = rays.far;
  for (std::size_t k = 0; k < placed_.size(); ++k) {
    const Affine& to_object = placed_[k].to_object;
    for (std::size_t ray = 0; ray < 8; ++ray) {
      local.origins[ray] = to_object * rays.origins[ray];
      local.directions[ray] = to_object.linear() * rays.directions[ray];
    }
    placed_[k].tree->nearest(local, near);
    for (std::size_t ray = 0; ray < 8; ++ray)
      if (local.hit[ray]) rays.hits[ray] = Hit{local.far[ray], k, local.triangle[ray]};
  }
  rays.far = local.far;
}

bool SceneRays::blocked(const Vec3& from, const Vec3& to) const {
  return std::any_of(placed_.begin(), placed_.end(), [&](const Placed& placed) {
    if (placed.passed_by(from, to - from)) return false;
    const Vec3 start = placed.to_object * from, way = placed.to_object * to - start;
    const double distance = way.norm();
    constexpr double rounding = 1e-5;  // of the object's size, ten times the tree's
    return distance > 0 && placed.tree->blocked(start, way, 0, 1 - rounding * std::max(1.0, placed.size / distance));
  });
}

bool SceneRays::shaded(const Vec3& from, const Vec3& direction) const {
  return std::any_of(placed_.begin(), placed_.end(), [&](const Placed& placed) {
    return !placed.passed_by(from, direction) &&
           placed.tree->blocked(placed.to_object * from, placed.to_object.linear() * direction, 0, placed.reach);
  });
}

}  // namespace rebake
