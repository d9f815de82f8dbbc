#pragma once

#include <algorithm>
#include <cmath>

#include "mesh_ops/base/types.h"

namespace rebake {

/// Distance of point p from the segment ab.
inline double distance_to_segment(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 along = b - a;
  const double length = along.squaredNorm();
  const double share = length > 0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0.0;
  return (p - (a + share * along)).stableNorm();
}

/// Distance of point p from the triangle abc. A triangle without area is treated as its edges.
inline double distance_to_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Vec3 normal = (b - a).cross(c - a);
  const double area = normal.squaredNorm();
  // p projects into the triangle if it lies on the inner side of all three edges.
  if (area > 0 && normal.dot((b - a).cross(p - a)) >= 0 && normal.dot((c - b).cross(p - b)) >= 0 &&
      normal.dot((a - c).cross(p - c)) >= 0)
    return std::abs(normal.dot(p - a)) / std::sqrt(area);
  return std::min({distance_to_segment(a, b, p), distance_to_segment(b, c, p), distance_to_segment(c, a, p)});
}

}  // namespace rebake
