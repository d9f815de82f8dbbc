#pragma once

#include <optional>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Between world points and a viewport's pixels (x right, y down, from its top left corner).
class Lens {
 public:
  Lens(const Camera& camera, int width, int height);
  /// Nothing behind the eye.
  std::optional<Vec2> pixel(const Vec3& world) const;
  /// From the eye through a pixel, of length 1 along the line of sight.
  Vec3 ray(const Vec2& pixel) const;
  const Vec3& eye() const { return eye_; }
  /// Along the line of sight.
  double depth(const Vec3& world) const;
  /// Scene units that a pixel spans at a world point's depth.
  double unit(const Vec3& world) const;

 private:
  Vec3 eye_;
  Mat3 rows_;
  double scale_;  ///< pixels a unit at depth 1
  Vec2 middle_;
};

/// What the pointer is over: the nearest opaque triangle of a visible node.
struct Picked {
  NodeId node;
  std::uint32_t triangle;
  Vec3 world;
};
std::optional<Picked> pick(const Scene& scene, const Lens& lens, const Vec2& pixel);

}  // namespace rebake
