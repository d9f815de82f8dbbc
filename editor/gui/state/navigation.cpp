#include "editor/gui/state/navigation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rebake {

namespace {

constexpr double closest_to_pole = 0.01;  // radians

Camera flown_to(const Camera& camera, const Vec3& target) {
  Camera result = camera;
  result.eye += target - camera.target;
  result.target = target;
  return result;
}

// Prepares a camera for orbiting: one that looks exactly up or down is tilted by closest_to_pole and gets the world's y
// axis as up vector. Others stay as they are.
Camera upright(const Camera& camera) {
  const Vec3 world_up(0, 1, 0);
  const Vec3 back = camera.eye - camera.target;
  const double distance = back.norm(), along = back.dot(world_up) / distance;
  if (std::abs(camera.up.dot(world_up)) > 1e-9 || std::abs(along) < 1 - 1e-9) return camera;
  Camera result = camera;
  const double side = along > 0 ? 1 : -1;
  const Vec3 aside = -side * camera.up.normalized();
  result.up = world_up;
  result.eye =
      camera.target + distance * (side * std::cos(closest_to_pole) * world_up + std::sin(closest_to_pole) * aside);
  return result;
}

// `direction` rotated about the camera's up axis and then towards that axis, by angles in radians.
Vec3 turned(const Camera& camera, const Vec3& direction, double about_up, double towards_up) {
  const Vec3 up = camera.up.normalized();
  const Vec3 level = Eigen::AngleAxisd(about_up, up) * direction;
  const double angle = std::acos(std::clamp(level.normalized().dot(up), -1.0, 1.0));
  const double wanted = std::clamp(angle - towards_up, closest_to_pole, std::numbers::pi - closest_to_pole);
  Vec3 side = up.cross(level);
  if (!(side.norm() > 1e-9 * level.norm())) side = up.unitOrthogonal();  // parallel to `up`: any axis will do
  return Eigen::AngleAxisd(wanted - angle, side.normalized()) * level;
}

}  // namespace

Camera orbited(const Camera& seen, double right_pixels, double down_pixels, int height) {
  const double turn = std::numbers::pi / height;
  const Camera camera = upright(seen);
  Camera result = camera;
  result.eye = camera.target + turned(camera, camera.eye - camera.target, -right_pixels * turn, down_pixels * turn);
  return result;
}

Camera looked_around(const Camera& seen, double right_pixels, double down_pixels, int height) {
  const double turn = std::numbers::pi / 2 / height;
  const Camera camera = upright(seen);
  Camera result = camera;
  result.target = camera.eye + turned(camera, camera.target - camera.eye, -right_pixels * turn, -down_pixels * turn);
  return result;
}

Camera panned(const Camera& camera, double right_pixels, double down_pixels, int height) {
  const double unit = 2 * half_height(camera, (camera.target - camera.eye).norm()) / height;
  return flown(camera, -right_pixels * unit, down_pixels * unit, 0);
}

Camera zoomed(const Camera& camera, const Vec3& towards, double factor) {
  Camera result = camera;
  result.eye = towards + (camera.eye - towards) * factor;
  result.target = towards + (camera.target - towards) * factor;
  result.ortho_height *= factor;
  // Below this distance, double precision cannot separate eye and target.
  const double least = std::max(1e-12 * result.target.norm(), std::numeric_limits<double>::min());
  const bool sound = (result.eye - result.target).norm() > least &&
                     (!camera.orthographic() || (result.ortho_height > least && std::isfinite(result.ortho_height)));
  return sound ? result : camera;
}

Camera framed(const Camera& camera, const Box& box, double aspect) {
  if (box.isEmpty()) return camera;
  // A single point only becomes the target.
  const double radius = box.diagonal().norm() / 2;
  if (!(radius > 1e-12 * box.center().norm())) return flown_to(camera, box.center());
  const double half = std::atan(std::tan(camera.fov_degrees * std::numbers::pi / 360) * std::min(1.0, aspect));
  Camera result = camera;
  if (camera.orthographic()) result.ortho_height = 2 * radius / std::min(1.0, aspect);
  result.target = box.center();
  result.eye = result.target + (camera.eye - camera.target).normalized() * (radius / std::sin(half));
  return result;
}

Camera flown(const Camera& camera, double right, double up, double forward) {
  const Mat3 rows = world_to_camera(camera);
  const Vec3 motion = rows.transpose() * Vec3(right, up, -forward);
  Camera result = camera;
  result.eye += motion;
  result.target += motion;
  return result;
}

Camera with_orbit_center(const Camera& camera, const Vec3& point) {
  // The depth of the point does not change.
  const Vec3 back = (camera.eye - camera.target).normalized();
  const double depth = (camera.eye - point).dot(back);
  if (!(depth > 0)) return camera;
  Camera result = camera;
  result.target = point;
  result.eye = point + depth * back;
  return result;
}

Camera along_axis(const Camera& camera, const Vec3& axis) {
  Camera result = camera;
  const double distance = (camera.eye - camera.target).norm();
  const Vec3 direction = axis.normalized();
  if (std::abs(axis.normalized().y()) < 1 - 1e-6) result.up = upright(camera).up;
  const Vec3 up = upright(camera).up.normalized();
  // Exactly along the up axis another up vector is needed; upright() reverts it when the camera orbits on.
  if (std::abs(direction.dot(up)) > 1 - 1e-6) {
    Vec3 level = upright(camera).eye - camera.target;
    level -= level.dot(up) * up;
    // The horizontal world axis nearest to the current direction keeps the picture upright.
    int largest = 0;
    level.cwiseAbs().maxCoeff(&largest);
    Vec3 snapped(0, 0, 0);
    snapped[largest] = level[largest] < 0 ? -1 : 1;
    if (!(level.norm() > 0)) return camera;  // it already looks along this axis
    result.up = direction.dot(up) > 0 ? Vec3(-snapped) : snapped;
  }
  result.eye = camera.target + direction * distance;
  return result;
}

Camera toggled_projection(const Camera& camera) {
  Camera result = camera;
  if (camera.orthographic()) {
    result.ortho_height = 0;
    result.eye =
        camera.target + (camera.eye - camera.target).normalized() * (camera.ortho_height / 2 / half_height(result, 1));
  } else {
    result.ortho_height = 2 * half_height(camera, (camera.eye - camera.target).norm());
  }
  return result;
}

std::vector<Camera> turntable(const Camera& camera, int count) {
  std::vector<Camera> cameras;
  constexpr int half_turn = 1000;  // pixels per 180°
  for (int k = 0; k < count; ++k) cameras.push_back(orbited(camera, 2.0 * half_turn * k / count, 0, half_turn));
  return cameras;
}

Camera with_clip_planes_for(const Camera& camera, const Box& box) {
  Camera result = camera;
  if (camera.orthographic() && !box.isEmpty()) {
    const Vec3 back = (camera.eye - camera.target).normalized();
    const double before = back.dot(box.center() - camera.target) + box.diagonal().norm();
    // The distance of an orthographic camera only affects the precision of depths.
    const double distance = std::max(before, 0.01 * box.diagonal().norm());
    const double now = (camera.eye - camera.target).norm();
    // A camera already at this distance must not change by a bit, or the picture would be drawn again.
    if (distance > 0 && std::abs(distance - now) > 1e-9 * distance) result.eye = camera.target + distance * back;
  }
  const double target = (result.target - result.eye).norm();
  double farthest = 2 * target;
  if (!box.isEmpty()) farthest = std::max(farthest, (box.center() - result.eye).norm() + box.diagonal().norm());
  result.far_plane = farthest * 2;
  // With reversed floating-point depth, a small near plane costs no precision.
  result.near_plane = std::min(target / 100, farthest / 1000);
  return result;
}

}  // namespace rebake
