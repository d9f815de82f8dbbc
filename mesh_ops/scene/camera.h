#pragma once

#include "mesh_ops/base/types.h"

namespace rebake {

/// A pinhole or orthographic camera in world space. Lengths are in scene units.
struct Camera {
  Vec3 eye{0, 2, 3.464};
  Vec3 target{0, 0, 0};
  Vec3 up{0, 1, 0};
  double fov_degrees = 39;   ///< vertical field of view of a pinhole, in (0, 180)
  double ortho_height = 0;   ///< visible height of an orthographic camera; 0: pinhole
  double near_plane = 0.01;  ///< depth of the near plane; 0: with_planes() fits it to the scene
  double far_plane = 1000;   ///< depth of the far plane; 0: with_planes() fits it to the scene

  bool orthographic() const { return ortho_height > 0; }
  bool operator==(const Camera&) const = default;
};

/// Half of the visible height at a depth along the view axis, in scene units.
double half_height(const Camera& camera, double depth);

/// The view ray through a point of a picture.
struct ViewRay {
  Vec3 origin;     ///< the eye; for an orthographic camera, a point of the image plane through the eye
  Vec3 direction;  ///< its component along the view axis is 1, so that the ray parameter is the depth
};

/// Rotation from world to camera space, with rows right, up, back (the camera looks along −z). Throws FieldError if eye
/// and target coincide. If `up` is parallel to the view axis, another axis replaces it.
Mat3 world_to_camera(const Camera& camera);

/// Replaces near and far planes that are 0 by planes that fit `visible`: nothing in the picture is clipped unless it is
/// nearer than 1/10000 of the farthest distance. `aspect`: width / height. Throws FieldError if the eye or a given
/// plane is too far away or too close to fit the other plane.
Camera with_planes(const Camera& camera, const Box& visible, double aspect);

/// Throws FieldError for fields that are not finite or out of range.
void check(const Camera& camera);

/// A camera that frames `bounds` at the given aspect (width / height), from the front and slightly above; for `forward`
/// scenes, along −z.
Camera framing(const Box& bounds, double aspect, bool forward, double fov_degrees = Camera{}.fov_degrees);

}  // namespace rebake
