#pragma once

#include <optional>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Maps between world points and pixels of a viewport (x right, y down, origin at its top left corner).
class ViewportProjection {
 public:
  /// `width`, `height`: size of the viewport in pixels.
  ViewportProjection(const Camera& camera, int width, int height);
  /// Projects a world point; nothing if it lies behind a perspective camera's eye.
  std::optional<Vec2> pixel(const Vec3& world) const;
  /// The view ray through a pixel.
  ViewRay ray(const Vec2& pixel) const;
  /// Unit vector from a world point towards the eye.
  Vec3 direction_to_eye(const Vec3& world) const;
  /// World displacement, parallel to the image plane, that moves `world` by this many pixels.
  Vec3 motion(const Vec3& world, const Vec2& pixels) const;
  /// Distance of the near clipping plane along the line of sight, in scene units.
  double near_plane() const { return camera_.near_plane; }
  /// Depth of a world point along the line of sight, in scene units.
  double depth(const Vec3& world) const;
  /// Size of a pixel at a world point's depth, in scene units; 0 behind a perspective camera's eye.
  double unit(const Vec3& world) const;

 private:
  Camera camera_;
  Mat3 rows_;      ///< world_to_camera()
  double height_;  ///< of the viewport, in pixels
  Vec2 middle_;    ///< centre of the viewport, in pixels
};

/// A hit of picking: the nearest opaque triangle under a pixel.
struct PickHit {
  NodeId node;
  std::uint32_t triangle;  ///< index in the node's object
  Vec3 world;              ///< the hit point
};
/// Casts a ray through a pixel into all visible nodes, from the near plane on; nothing if it hits none. If `waits` is
/// false, nodes without a cached ray tree are skipped, because building one is slow.
std::optional<PickHit> pick(const Scene& scene, const ViewportProjection& lens, const Vec2& pixel, bool waits = true);

}  // namespace rebake
