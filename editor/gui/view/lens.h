#pragma once

#include <optional>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Between world points and a viewport's pixels (x right, y down, from its top left corner).
class Lens {
 public:
  Lens(const Camera& camera, int width, int height);
  /// Nothing behind a perspective camera's eye.
  std::optional<Vec2> pixel(const Vec3& world) const;
  ViewRay ray(const Vec2& pixel) const;
  /// From a world point to where it is looked at from, of length 1.
  Vec3 towards_eye(const Vec3& world) const;
  /// What a way on the screen is in the world, at a world point's depth.
  Vec3 motion(const Vec3& world, const Vec2& pixels) const;
  /// Nothing nearer than this is seen, along the line of sight.
  double near_plane() const { return camera_.near_plane; }
  /// Along the line of sight.
  double depth(const Vec3& world) const;
  /// Scene units that a pixel spans at a world point's depth.
  double unit(const Vec3& world) const;

 private:
  Camera camera_;
  Mat3 rows_;
  double height_;  ///< pixels
  Vec2 middle_;
};

/// What the pointer is over: the nearest opaque triangle of a visible node. With `waits` false, nodes that were not
/// looked through yet (up to a second for a million triangles) are passed over.
struct Picked {
  NodeId node;
  std::uint32_t triangle;
  Vec3 world;
};
std::optional<Picked> pick(const Scene& scene, const Lens& lens, const Vec2& pixel, bool waits = true);

}  // namespace rebake
