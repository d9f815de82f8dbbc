#include "mesh_ops/index/footprint.h"

#include <limits>

namespace rebake {

namespace {

// A convex polygon: a triangle cut by up to four half-planes.
struct Polygon {
  std::array<Vec2, 7> corners;
  std::size_t count = 0;
  void add(const Vec2& corner) { corners[count++] = corner; }
};

// The part with sign · (coordinate − bound) ≥ 0 (Sutherland and Hodgman 1974).
Polygon clipped(const Polygon& polygon, Eigen::Index axis, double sign, double bound) {
  if (std::isinf(bound)) return polygon;
  Polygon result;
  for (std::size_t k = 0; k < polygon.count; ++k) {
    const Vec2 &a = polygon.corners[k], &b = polygon.corners[(k + 1) % polygon.count];
    const double from = sign * (a[axis] - bound), to = sign * (b[axis] - bound);
    if (from >= 0) result.add(a);
    if ((from < 0 && to > 0) || (from > 0 && to < 0)) {
      Vec2 cut = a + (b - a) * (from / (from - to));
      cut[axis] = bound;
      result.add(cut);
    }
  }
  return result;
}

Polygon between(const Polygon& polygon, Eigen::Index axis, int texel, int size) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Polygon above = clipped(polygon, axis, 1, texel == 0 ? -infinity : texel);
  return clipped(above, axis, -1, texel == size - 1 ? infinity : texel + 1);
}

// First and last texel that a polygon touches along an axis.
std::array<int, 2> texels_along(const Polygon& polygon, Eigen::Index axis, int size) {
  double low = polygon.corners[0][axis], high = low;
  for (std::size_t k = 1; k < polygon.count; ++k) {
    low = std::min(low, polygon.corners[k][axis]);
    high = std::max(high, polygon.corners[k][axis]);
  }
  return {texel_within(low, size), texel_within(high, size)};
}

}  // namespace

void for_each_texel_piece(const std::array<Vec2, 3>& p, int width, int height,
                          const std::function<void(int x, int y, double area, const Vec2& centroid)>& visit) {
  if (!p[0].allFinite() || !p[1].allFinite() || !p[2].allFinite()) return;
  Polygon triangle;
  for (const Vec2& corner : p) triangle.add(corner);
  const auto [top, bottom] = texels_along(triangle, 1, height);
  for (int y = top; y <= bottom; ++y) {
    const Polygon row = between(triangle, 1, y, height);
    if (row.count < 3) continue;
    const auto [left, right] = texels_along(row, 0, width);
    for (int x = left; x <= right; ++x) {
      const Polygon piece = between(row, 0, x, width);
      double doubled = 0;
      Vec2 moment = Vec2::Zero();
      for (std::size_t k = 1; k + 1 < piece.count; ++k) {
        const Vec2 a = piece.corners[k] - piece.corners[0], b = piece.corners[k + 1] - piece.corners[0];
        const double part = std::abs(a.x() * b.y() - a.y() * b.x());
        doubled += part;
        moment += part * (a + b) / 3;
      }
      if (doubled > 0) visit(x, y, doubled / 2, piece.corners[0] + moment / doubled);
    }
  }
}

}  // namespace rebake
