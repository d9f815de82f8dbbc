#pragma once

#include "mesh_ops/scene/types.h"

namespace rebake {

/// A pinhole camera in world space. Lengths are in the scene's units.
struct Camera {
  Vec3 eye{0, 2, 3.464};
  Vec3 target{0, 0, 0};
  Vec3 up{0, 1, 0};
  double fov_degrees = 39;  ///< vertical field of view, in (0, 180)
  double near_plane = 0.01;
  double far_plane = 1000;

  bool operator==(const Camera&) const = default;
};

/// Rows right, up, back: turns world directions into camera directions (the camera looks along −z).
/// Throws FieldError if eye and target coincide; an `up` along the line of sight is replaced by another axis.
Mat3 world_to_camera(const Camera& camera);

/// Throws FieldError for fields that are not finite or out of range.
void check(const Camera& camera);

/// A camera that sees all of `bounds` at the given aspect (width / height), from the front and slightly above.
/// `forward` scenes are looked at along −z.
Camera framing(const Box& bounds, double aspect, bool forward, double fov_degrees = Camera{}.fov_degrees);

}  // namespace rebake
