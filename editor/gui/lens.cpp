#include "editor/gui/lens.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "mesh_ops/select/index.h"

namespace rebake {

Lens::Lens(const Camera& camera, int width, int height)
    : eye_(camera.eye),
      rows_(world_to_camera(camera)),
      scale_(height / 2.0 / std::tan(camera.fov_degrees * std::numbers::pi / 360)),
      middle_(width / 2.0, height / 2.0) {}

std::optional<Vec2> Lens::pixel(const Vec3& world) const {
  const Vec3 p = rows_ * (world - eye_);
  if (!(p.z() < 0)) return std::nullopt;
  return Vec2(middle_ + Vec2(p.x(), -p.y()) * (scale_ / -p.z()));
}
Vec3 Lens::ray(const Vec2& pixel) const {
  const Vec2 p = (pixel - middle_) / scale_;
  return rows_.transpose() * Vec3(p.x(), -p.y(), -1);
}
double Lens::depth(const Vec3& world) const { return -(rows_ * (world - eye_)).z(); }
double Lens::unit(const Vec3& world) const { return std::max(0.0, depth(world)) / scale_; }

std::optional<Picked> pick(const Scene& scene, const Lens& lens, const Vec2& pixel) {
  std::optional<Picked> nearest;
  const Vec3 direction = lens.ray(pixel);
  double least = std::numeric_limits<double>::infinity();
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.visible || !placed.node->object) continue;
    const Affine to_object = placed.to_world.inverse();
    const auto hit =
        rays_of(*placed.node->object)->nearest(to_object * lens.eye(), to_object.linear() * direction, 0, least);
    if (!hit || hit->t >= least) continue;
    least = hit->t;
    nearest = Picked{placed.node->id, hit->triangle, lens.eye() + hit->t * direction};
  }
  return nearest;
}

}  // namespace rebake
