#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Corners of a face in texel coordinates of its texture, y pointing down: texel (x, y) is the square [x, x+1) × [y,
/// y+1).
inline std::array<Vec2, 3> texel_corners(const TextureSet& set, std::size_t face) {
  std::array<Vec2, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2& uv = set.soup.uvs()[set.soup.faces()[face][k]];
    corners[k] = {uv.x() * set.texels->width(), (1 - uv.y()) * set.texels->height()};
  }
  return corners;
}

/// Index of the texel that contains a coordinate in texels, clamped to 0 … size − 1. NaN is not allowed.
inline int texel_within(double coordinate, int size) {
  return static_cast<int>(std::clamp(std::floor(coordinate), 0.0, size - 1.0));
}

/// Calls visit(y, begin, end) for each row of texels whose centres lie in the triangle, begin ≤ x < end, clamped to the
/// texture. A centre on an edge shared by two triangles counts for one or both.
template <class Visit>
void for_each_row_inside(const std::array<Vec2, 3>& p, int width, int height, Visit visit) {
  const double top = std::min({p[0].y(), p[1].y(), p[2].y()}), bottom = std::max({p[0].y(), p[1].y(), p[2].y()});
  const int first = static_cast<int>(std::ceil(std::clamp(top - 0.5, 0.0, static_cast<double>(height))));
  const int last = static_cast<int>(std::floor(std::clamp(bottom - 0.5, -1.0, height - 1.0)));
  for (int y = first; y <= last; ++y) {
    double left = 1e300, right = -1e300;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 &a = p[k], &b = p[(k + 1) % 3];
      const double row = y + 0.5;
      if ((a.y() < row && b.y() < row) || (a.y() > row && b.y() > row)) continue;
      if (a.y() == b.y()) {
        left = std::min({left, a.x(), b.x()});
        right = std::max({right, a.x(), b.x()});
        continue;
      }
      const double x = a.x() + (b.x() - a.x()) * ((row - a.y()) / (b.y() - a.y()));
      left = std::min(left, x);
      right = std::max(right, x);
    }
    const int begin = static_cast<int>(std::ceil(std::clamp(left - 0.5, 0.0, static_cast<double>(width))));
    const int end = static_cast<int>(std::floor(std::clamp(right - 0.5, -1.0, width - 1.0)));
    if (begin <= end) visit(y, begin, end + 1);
  }
}

/// Calls visit(x, y) for each texel whose centre lies in the triangle.
template <class Visit>
void for_each_texel_inside(const std::array<Vec2, 3>& p, int width, int height, Visit visit) {
  for_each_row_inside(p, width, height, [&](int y, int begin, int end) {
    for (int x = begin; x < end; ++x) visit(x, y);
  });
}

/// Calls visit(x, y, area, centroid) for each texel whose square overlaps the triangle: area of the overlap in texels²,
/// and its centroid in texel coordinates. Border texels extend to infinity, as under clamping. Nothing for coordinates
/// that are not finite.
void for_each_texel_piece(const std::array<Vec2, 3>& p, int width, int height,
                          const std::function<void(int x, int y, double area, const Vec2& centroid)>& visit);

/// Barycentric coordinates of a point; (1, 0, 0) if the triangle has no area.
inline Vec3 barycentric(const std::array<Vec2, 3>& p, const Vec2& at) {
  const Vec2 a = p[1] - p[0], b = p[2] - p[0], c = at - p[0];
  const double area = a.x() * b.y() - a.y() * b.x();
  if (area == 0) return {1, 0, 0};
  const double v = (c.x() * b.y() - c.y() * b.x()) / area, w = (a.x() * c.y() - a.y() * c.x()) / area;
  return {1 - v - w, v, w};
}

}  // namespace rebake
