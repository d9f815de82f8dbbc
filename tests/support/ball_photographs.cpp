#include "tests/support/ball_photographs.h"

#include <cmath>
#include <numbers>

namespace rebake {

namespace {

// Colour of the ball along a ray, by the normal where it is hit; white beside it. Four rays per pixel.
Vec3 color_of(const Vec3& eye, const Vec3& direction) {
  const double a = direction.squaredNorm(), b = eye.dot(direction), c = eye.squaredNorm() - 0.25, root = b * b - a * c;
  if (!(root > 0)) return Vec3::Ones();
  const Vec3 normal = 2 * (eye + (-b - std::sqrt(root)) / a * direction);
  return (0.45 + 0.35 * normal.array()).matrix();
}

}  // namespace

std::vector<FitPhotograph> ball_photographs(int count, int side, double phase) {
  std::vector<FitPhotograph> photographs;
  for (int k = 0; k < count; ++k) {
    FitPhotograph one;
    const double angle = 2 * std::numbers::pi * (k + phase) * 0.6180339887498949,
                 up = 0.8 * (2 * (k + 0.5 + 0.4 * phase) / count - 1), across = std::sqrt(1 - up * up);
    one.camera.eye = 2 * Vec3(across * std::cos(angle), up, across * std::sin(angle));
    one.width = one.height = side;
    const Mat3 to_scene = world_to_camera(one.camera).transpose();
    const double focal = side / (2 * std::tan(one.camera.fov_degrees * std::numbers::pi / 360));
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        Vec3 sum = Vec3::Zero();
        for (int s = 0; s < 4; ++s)
          sum += color_of(one.camera.eye, to_scene * Vec3((x + 0.25 + s % 2 * 0.5 - side / 2.0) / focal,
                                                          -(y + 0.25 + s / 2 * 0.5 - side / 2.0) / focal, -1)) /
                 4;
        for (const double value : sum) one.rgb.push_back(static_cast<std::uint8_t>(std::lround(255 * value)));
      }
    one.valid.assign(one.rgb.size() / 3, 1);
    photographs.push_back(std::move(one));
  }
  return photographs;
}

}  // namespace rebake
