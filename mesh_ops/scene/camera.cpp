#include "mesh_ops/scene/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh_ops/base/elementary.h"
#include "mesh_ops/base/error.h"

namespace rebake {

double half_height(const Camera& camera, double depth) {
  if (camera.orthographic()) return camera.ortho_height / 2;
  const auto half = elementary::sine_cosine(camera.fov_degrees * std::numbers::pi / 360);
  return depth * (half.sine / half.cosine);
}

Mat3 world_to_camera(const Camera& camera) {
  const Vec3 back = (camera.eye - camera.target).stableNormalized();
  if (back.squaredNorm() == 0) throw FieldError("target", "is the same point as the eye");
  Vec3 right = camera.up.stableNormalized().cross(back);
  if (right.norm() < 1e-9) {
    Vec3 other = Vec3::Zero();
    int smallest = 0;
    back.cwiseAbs().minCoeff(&smallest);
    other[smallest] = 1;
    right = other.cross(back);
  }
  right.normalize();
  Mat3 rows;
  rows.row(0) = right;
  rows.row(1) = back.cross(right);
  rows.row(2) = back;
  return rows;
}

void check(const Camera& camera) {
  if (!camera.eye.allFinite()) throw FieldError("eye", "is not finite");
  if (!camera.target.allFinite()) throw FieldError("target", "is not finite");
  if (!camera.up.allFinite() || camera.up.isZero(0)) throw FieldError("up", "must be a finite, non-zero vector");
  if (!(camera.fov_degrees > 0 && camera.fov_degrees < 180))
    throw FieldError("fov", "must lie between 0 and 180 degrees");
  if (!(camera.ortho_height >= 0) || !std::isfinite(camera.ortho_height))
    throw FieldError("ortho_height", "must be greater than 0 (orthographic), or 0 (perspective)");
  if (!(camera.near_plane >= 0) || !std::isfinite(camera.near_plane))
    throw FieldError("near", "must be greater than 0, or 0 to fit it to the scene");
  if (camera.far_plane != 0 && (!(camera.far_plane > camera.near_plane) || !std::isfinite(camera.far_plane)))
    throw FieldError("far", "must be greater than near, or 0 to fit it to the scene");
  world_to_camera(camera);
}

Camera with_planes(const Camera& camera, const Box& visible, double aspect) {
  constexpr double depth_range = 1e4;  // far / near, if the eye lies inside the visible box
  // Errors name the plane that the caller gave.
  if (camera.far_plane == 0 && !std::isfinite(depth_range * camera.near_plane))
    throw FieldError("near", "is too far away: the far plane would not be finite");
  if (camera.near_plane == 0 && camera.far_plane != 0 && !(camera.far_plane / depth_range > 0))
    throw FieldError("far", "is too close to the eye: the near plane would be 0");
  Camera result = camera;
  const bool extends = !visible.isEmpty() && visible.min().allFinite() && visible.max().allFinite() &&
                       (visible.center() != camera.eye || visible.min() != visible.max());
  if (!extends) {
    if (result.near_plane == 0)
      result.near_plane =
          camera.far_plane == 0 ? Camera{}.near_plane : std::min(Camera{}.near_plane, camera.far_plane / depth_range);
    if (result.far_plane == 0) result.far_plane = std::max(Camera{}.far_plane, depth_range * result.near_plane);
    return result;
  }
  const double farthest = (visible.center() - camera.eye).stableNorm() + visible.diagonal().stableNorm();
  if (!std::isfinite(farthest)) throw FieldError("eye", "is too far from the scene: the distance is not finite");
  if (result.far_plane == 0) result.far_plane = std::max(farthest, 2 * result.near_plane);
  if (result.near_plane == 0) {
    // Ratio of depth to distance in the picture's corner.
    const double up = half_height(camera, 1), right = up * aspect;
    const double corner = camera.orthographic() ? 0.0 : 1 / std::sqrt(1 + up * up + right * right);
    const double nearest = visible.exteriorDistance(camera.eye) * std::min(0.5, corner);
    result.near_plane = std::max(nearest, farthest / depth_range);
    if (result.near_plane >= result.far_plane) result.near_plane = result.far_plane / depth_range;
  }
  return result;
}

Camera framing(const Box& bounds, double aspect, bool forward, double fov_degrees) {
  Camera camera;
  if (!(fov_degrees > 0 && fov_degrees < 180)) throw FieldError("fov", "must lie between 0 and 180 degrees");
  camera.fov_degrees = fov_degrees;
  if (bounds.isEmpty()) return camera;
  const Vec3 center = bounds.center();
  const double radius = std::max(bounds.diagonal().norm() / 2, 1e-30);
  const Vec3 direction = forward ? Vec3(0, 0, 1) : Vec3(0.35, 0.45, 1).normalized();
  const double half_fov = camera.fov_degrees / 2 * std::numbers::pi / 180;
  const double narrow = std::min(half_fov, std::atan(std::tan(half_fov) * aspect));
  const double distance = radius / std::sin(narrow);
  camera.target = center;
  camera.eye = center + direction * distance;
  camera.near_plane = std::max((distance - radius) / 2, distance * 1e-4);
  camera.far_plane = distance + 2 * radius;
  return camera;
}

}  // namespace rebake
