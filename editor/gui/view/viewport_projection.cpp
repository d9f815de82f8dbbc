#include "editor/gui/view/viewport_projection.h"

#include <cmath>
#include <limits>

#include "mesh_ops/index/index.h"

namespace rebake {

ViewportProjection::ViewportProjection(const Camera& camera, int width, int height)
    : camera_(camera), rows_(world_to_camera(camera)), height_(height), middle_(width / 2.0, height / 2.0) {}

std::optional<Vec2> ViewportProjection::pixel(const Vec3& world) const {
  const Vec3 p = rows_ * (world - camera_.eye);
  if (!(p.z() < 0) && !camera_.orthographic()) return std::nullopt;
  return Vec2(middle_ + Vec2(p.x(), -p.y()) * (height_ / 2 / half_height(camera_, -p.z())));
}
ViewRay ViewportProjection::ray(const Vec2& pixel) const {
  const Vec2 p = (pixel - middle_) * (half_height(camera_, 1) * 2 / height_);
  const Vec3 aside = rows_.transpose() * Vec3(p.x(), -p.y(), 0), forward = -rows_.row(2).transpose();
  if (camera_.orthographic()) return {camera_.eye + aside, forward};
  return {camera_.eye, aside + forward};
}
double ViewportProjection::depth(const Vec3& world) const { return -(rows_ * (world - camera_.eye)).z(); }
double ViewportProjection::unit(const Vec3& world) const {
  return std::max(0.0, half_height(camera_, depth(world))) * 2 / height_;
}
Vec3 ViewportProjection::direction_to_eye(const Vec3& world) const {
  return camera_.orthographic() ? Vec3(rows_.row(2)) : Vec3((camera_.eye - world).stableNormalized());
}
Vec3 ViewportProjection::motion(const Vec3& world, const Vec2& pixels) const {
  return unit(world) * (rows_.transpose() * Vec3(pixels.x(), -pixels.y(), 0));
}

std::optional<PickHit> pick(const Scene& scene, const ViewportProjection& lens, const Vec2& pixel, bool waits) {
  std::vector<NodeId> ids;
  std::vector<SceneRays::Instance> instances;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.visible || !placed.node->object) continue;
    auto tree = waits ? rays_of(*placed.node->object) : try_rays_of(*placed.node->object);
    if (!tree) continue;
    ids.push_back(placed.node->id);
    instances.push_back({std::move(tree), placed.to_world, placed.node->object->bounds().diagonal().norm()});
  }
  const ViewRay ray = lens.ray(pixel);
  const auto hit = SceneRays(std::move(instances))
                       .nearest(ray.origin, ray.direction, lens.near_plane(), std::numeric_limits<double>::infinity());
  if (!hit) return std::nullopt;
  return PickHit{ids[hit->instance], hit->triangle, ray.origin + hit->t * ray.direction};
}

}  // namespace rebake
