#include "mesh_ops/scene/photo_camera.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/polar.h"

namespace rebake {

namespace {

constexpr double degrees_per_radian = 180 / std::numbers::pi;

// (x, y, z) becomes (x, z, −y).
Mat3 y_up_from_z_up() { return (Mat3() << 1, 0, 0, 0, 0, 1, 0, -1, 0).finished(); }

std::vector<PhotoCamera> turned(std::vector<PhotoCamera> cameras, const Mat3& turn) {
  for (PhotoCamera& camera : cameras) {
    camera.axes = turn * camera.axes;
    camera.eye = turn * camera.eye;
  }
  return cameras;
}

// The point nearest to all view axes in the least-squares sense; the mean of the eyes if the axes are parallel.
Vec3 meeting_point(const std::vector<PhotoCamera>& cameras) {
  Vec3 middle = Vec3::Zero();
  for (const PhotoCamera& camera : cameras) middle += camera.eye / static_cast<double>(cameras.size());
  Mat3 normal = Mat3::Zero();
  Vec3 right = Vec3::Zero();
  for (const PhotoCamera& camera : cameras) {
    const Vec3 axis = camera.axes.col(2);
    const Mat3 across = Mat3::Identity() - axis * axis.transpose();
    normal += across;
    right += across * (camera.eye - middle);
  }
  const Eigen::LDLT<Mat3> solver(normal);
  constexpr double least_angle = 1e-6;  // of the eigenvalues' ratio; parallel axes have 0
  if (!(solver.rcond() > least_angle)) return middle;
  return middle + solver.solve(right);
}

}  // namespace

std::vector<PhotoCamera> with_y_up(std::vector<PhotoCamera> cameras, WorldUp up) {
  return up == WorldUp::y ? cameras : turned(std::move(cameras), y_up_from_z_up());
}

std::vector<PhotoCamera> from_y_up(std::vector<PhotoCamera> cameras, WorldUp up) {
  return up == WorldUp::y ? cameras : turned(std::move(cameras), y_up_from_z_up().transpose());
}

std::vector<Camera> views_of(const std::vector<PhotoCamera>& cameras, std::vector<std::string>& notes) {
  std::vector<Camera> views;
  if (cameras.empty()) return views;
  const Vec3 meeting = meeting_point(cameras);
  double spread = 0;
  for (const PhotoCamera& camera : cameras)
    spread = std::max({spread, camera.eye.norm(), (camera.eye - cameras.front().eye).norm()});
  std::size_t distorted = 0, off_center = 0, not_square = 0;
  double farthest = 0;
  for (const PhotoCamera& camera : cameras) {
    check(camera);
    const Vec3 forward = -camera.axes.col(2);
    const double depth = (meeting - camera.eye).dot(forward), size = (meeting - camera.eye).norm();
    Camera view;
    view.eye = camera.eye;
    // In front of the camera, also where the axes meet behind it. Where they meet at it, the distance has no meaning.
    constexpr double rounding = 1e-6;
    const double distance = depth > 1e-3 * size ? depth : size;
    view.target = camera.eye + forward * (distance > rounding * spread ? distance : std::max(1.0, rounding * spread));
    view.up = camera.axes.col(1);
    view.fov_degrees = 2 * std::atan(camera.height / (2 * camera.focal.y())) * degrees_per_radian;
    view.near_plane = view.far_plane = 0;
    check(view);
    views.push_back(view);
    const Vec2 shift = camera.center - Vec2(camera.width, camera.height) / 2;
    farthest = std::max(farthest, shift.norm());
    distorted += camera.distortion.none() ? 0 : 1;
    off_center += shift.norm() > 0.5 ? 1 : 0;
    not_square += std::abs(camera.focal.x() / camera.focal.y() - 1) > 1e-3 ? 1 : 0;
  }
  if (distorted > 0)
    notes.push_back(counted(distorted, "camera has", "cameras have") + " lens distortion, which views do not have");
  if (off_center > 0)
    notes.push_back(
        fmt::format("{} a principal point off the centre of the picture, by up to {:.1f} "
                    "pixels; views have it in the centre",
                    counted(off_center, "camera has", "cameras have"), farthest));
  if (not_square > 0)
    notes.push_back(counted(not_square, "camera has", "cameras have") +
                    " pixels that are not square; views use the vertical field of view");
  return views;
}

PhotoCamera photo_camera(const Camera& view, const std::string& name, int width, int height) {
  if (view.orthographic()) throw FieldError("camera", "is orthographic; camera files hold perspective cameras only");
  PhotoCamera camera;
  camera.name = name;
  camera.axes = world_to_camera(view).transpose();
  camera.eye = view.eye;
  camera.width = width;
  camera.height = height;
  const double focal = height / (2 * std::tan(view.fov_degrees / degrees_per_radian / 2));
  camera.focal = {focal, focal};
  camera.center = Vec2(width, height) / 2;
  return camera;
}

namespace {

// The distorted radius of a point at radius r on the image plane at depth 1, without tangential terms.
double distorted_radius(const LensDistortion& lens, double r) {
  const auto& k = lens.radial;
  const auto growth = [&](double x2) { return 1 + x2 * (k[0] + x2 * (k[1] + x2 * (k[2] + x2 * k[3]))); };
  if (lens.fisheye) {
    const double angle = std::atan(r);
    return angle * growth(angle * angle);
  }
  const auto& d = lens.divisor;
  const double r2 = r * r;
  return r * growth(r2) / (1 + r2 * (d[0] + r2 * (d[1] + r2 * d[2])));
}

// Whether the distorted radius grows all the way from the axis to r; beyond, the model folds back into the picture.
bool grows_until(const LensDistortion& lens, double r) {
  constexpr int steps = 16;
  double before = 0;
  for (int k = 1; k <= steps; ++k) {
    const double now = distorted_radius(lens, r * k / steps);
    if (!(now > before)) return false;
    before = now;
  }
  return true;
}

}  // namespace

std::optional<Vec2> pixel_of(const PhotoCamera& camera, const Vec3& world) {
  const Vec3 local = camera.axes.transpose() * (world - camera.eye);
  if (!(local.z() < 0)) return std::nullopt;
  Vec2 plane(local.x() / -local.z(), local.y() / local.z());
  const LensDistortion& lens = camera.distortion;
  if (!lens.none()) {
    const double r = plane.norm(), x = plane.x(), y = plane.y();
    if (!grows_until(lens, r)) return std::nullopt;
    if (r > 0) plane *= distorted_radius(lens, r) / r;
    const auto [p1, p2] = lens.tangential;
    plane += Vec2(2 * p1 * x * y + p2 * (r * r + 2 * x * x), p1 * (r * r + 2 * y * y) + 2 * p2 * x * y);
  }
  const Vec2 pixel = plane.cwiseProduct(camera.focal) + camera.center;
  return pixel.allFinite() ? std::optional(pixel) : std::nullopt;
}

void check(const PhotoCamera& camera) {
  const std::string who = camera.name.empty() ? "a camera" : camera.name;
  if (!camera.eye.allFinite() || !camera.axes.allFinite() || !camera.focal.allFinite() || !camera.center.allFinite())
    throw FieldError("camera", who + " has values that are not finite");
  if (camera.width <= 0 || camera.height <= 0) throw FieldError("camera", who + " has no picture size");
  if (!(camera.focal.minCoeff() > 0)) throw FieldError("camera", who + " has a focal length that is not positive");
  rotation_of_pose(camera.axes, who);
}

Mat3 rotation_of_pose(const Mat3& columns, const std::string& field) {
  if (!columns.allFinite()) throw FieldError(field, "has values that are not finite");
  const double largest = columns.cwiseAbs().maxCoeff();
  if (!(largest > 0)) throw FieldError(field, "is zero");
  const Mat3 scaled = columns / largest * (std::sqrt(3.0) / (columns / largest).norm());
  const LocalRotation nearest = local_rotation(scaled);
  constexpr double tolerance = 1e-3;
  if (!nearest.defined || (nearest.rotation - scaled).norm() > tolerance)
    throw FieldError(field, "is not a rotation: its columns are not perpendicular, of unequal length, or mirrored");
  return nearest.rotation;
}

}  // namespace rebake
