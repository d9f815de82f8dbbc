#include "mesh_ops/scene/ground_plane.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace rebake {

Mat3 ground_frame(const Ground& ground) {
  const Vec3& n = ground.normal;
  if (n.y() < 0) {
    const Mat3 over = Vec3(1, -1, -1).asDiagonal();  // 180° about x
    return over * ground_frame({over * n, 0});
  }
  // Rodrigues: R = I + [v] + [v]²/(1 + c) with v = y × n and c = y · n.
  Mat3 cross;
  cross << 0, n.x(), 0, -n.x(), 0, -n.z(), 0, n.z(), 0;
  return Mat3::Identity() + cross + cross * cross / (1 + n.y());
}

double lowest_above(const Ground& ground, const Box& box) {
  double lowest = std::numeric_limits<double>::infinity();
  for (int corner = 0; corner < 8; ++corner)
    lowest = std::min(lowest, ground.above(box.corner(static_cast<Box::CornerType>(corner))));
  return lowest;
}

Ground ground_through(const std::array<Vec3, 3>& points) {
  constexpr double min_sine = 1e-9;
  const Vec3 a = points[1] - points[0], b = points[2] - points[0];
  const Vec3 along = a.stableNormalized(), across = b.stableNormalized();
  Vec3 normal = along.cross(across);
  const double sine = normal.norm();
  if (!(sine > min_sine) || !points[0].allFinite())
    throw std::invalid_argument("the points are collinear or not finite");
  normal /= sine;
  int largest = 1;
  if (std::abs(normal.y()) <= min_sine) normal.cwiseAbs().maxCoeff(&largest);
  if (normal[largest] < 0) normal = -normal;
  return {normal, normal.dot(points[0])};
}

}  // namespace rebake
