#pragma once

#include "mesh_ops/base/types.h"

namespace rebake {

/// A camera in world space: a pinhole, or orthographic. Lengths are in the scene's units.
struct Camera {
  Vec3 eye{0, 2, 3.464};
  Vec3 target{0, 0, 0};
  Vec3 up{0, 1, 0};
  double fov_degrees = 39;   ///< vertical field of view of a pinhole, in (0, 180)
  double ortho_height = 0;   ///< above 0 the camera is orthographic: its picture shows so much from top to bottom
  double near_plane = 0.01;  ///< 0: with_planes fits it to the scene
  double far_plane = 1000;   ///< likewise

  bool orthographic() const { return ortho_height > 0; }
  bool operator==(const Camera&) const = default;
};

/// Half of what the picture shows from top to bottom at a depth along the line of sight.
double half_height(const Camera& camera, double depth);

/// What a point of a picture shows lies along this.
struct ViewRay {
  Vec3 origin;     ///< the eye; of an orthographic camera a point of the plane through it
  Vec3 direction;  ///< of length 1 along the line of sight
};

/// Rows right, up, back: turns world directions into camera directions (the camera looks along −z).
/// Throws FieldError if eye and target coincide; an `up` along the line of sight is replaced by another axis.
Mat3 world_to_camera(const Camera& camera);

/// The camera with near and far planes that fit `visible`, where it leaves them open: nothing in the picture is cut
/// off, but for what lies nearer than a ten-thousandth of the farthest. Throws FieldError for an eye too far away.
Camera with_planes(const Camera& camera, const Box& visible, double aspect);

/// Throws FieldError for fields that are not finite or out of range.
void check(const Camera& camera);

/// A camera that sees all of `bounds` at the given aspect (width / height), from the front and slightly above.
/// `forward` scenes are looked at along −z.
Camera framing(const Box& bounds, double aspect, bool forward, double fov_degrees = Camera{}.fov_degrees);

}  // namespace rebake
