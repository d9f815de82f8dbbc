#include "editor/gui/panels/euler.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rebake {

namespace {

constexpr double degree = std::numbers::pi / 180;

// Sine of an angle in degrees; exact at multiples of 90°.
double sine(double degrees) {
  const double turned = std::remainder(degrees, 360);
  return std::remainder(turned, 180) == 0 ? 0
         : std::abs(turned) == 90         ? std::copysign(1, turned)
                                          : std::sin(turned * degree);
}
double cosine(double degrees) { return sine(degrees + 90); }

Mat3 about(int axis, double degrees) {
  const int next = (axis + 1) % 3, last = (axis + 2) % 3;
  Mat3 result = Mat3::Identity();
  result(next, next) = result(last, last) = cosine(degrees);
  result(last, next) = sine(degrees);
  result(next, last) = -sine(degrees);
  return result;
}

}  // namespace

Mat3 rotation_of(const Vec3& degrees) { return about(2, degrees.z()) * about(1, degrees.y()) * about(0, degrees.x()); }

Vec3 euler_degrees(const Mat3& r) {
  // The first column is (cy cz, cy sz, −sy). The length of its x and y is |cos Y|, which is near 0 in gimbal lock.
  const double level = std::hypot(r(0, 0), r(1, 0));
  const double y = std::atan2(-r(2, 0), level);
  Vec3 angles(0, y, 0);
  if (level > 1e-12) {
    angles.x() = std::atan2(r(2, 1), r(2, 2));
    angles.z() = std::atan2(r(1, 0), r(0, 0));
  } else {
    angles.x() = std::atan2(-r(1, 2), r(1, 1));
  }
  return angles / degree;
}

}  // namespace rebake
