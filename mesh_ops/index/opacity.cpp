#include "mesh_ops/index/opacity.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rebake {

namespace {

// Line through an edge: normal · p + offset is the signed distance of p in texels, positive inside the triangle.
struct Edge {
  Vec2 normal;
  double offset;
};

bool shows_opaque(const FeatureTexture& texels, std::array<Vec2, 3> p) {
  // Unknown UVs may show any texel.
  if (!(p[0].allFinite() && p[1].allFinite() && p[2].allFinite())) return true;
  const Vec2 low = p[0].cwiseMin(p[1]).cwiseMin(p[2]), high = p[0].cwiseMax(p[1]).cwiseMax(p[2]);
  if (!(low.minCoeff() >= 0 && high.x() <= texels.width() && high.y() <= texels.height())) return true;
  const double doubled_area = (p[1] - p[0]).x() * (p[2] - p[0]).y() - (p[1] - p[0]).y() * (p[2] - p[0]).x();
  if (doubled_area < 0) std::swap(p[1], p[2]);
  std::array<Edge, 3> edges;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 along = p[(k + 1) % 3] - p[k];
    const double length = along.norm();
    // A degenerate triangle has no inside: all texels of its bounding box count.
    edges[k].normal = doubled_area == 0 || length == 0 ? Vec2(0, 0) : Vec2(Vec2(-along.y(), along.x()) / length);
    edges[k].offset = -edges[k].normal.dot(p[k]);
  }
  const int left = std::max(0, static_cast<int>(std::floor(low.x())) - 1);
  const int right = std::min(texels.width() - 1, static_cast<int>(std::floor(high.x())) + 1);
  const int top = std::max(0, static_cast<int>(std::floor(low.y())) - 1);
  const int bottom = std::min(texels.height() - 1, static_cast<int>(std::floor(high.y())) + 1);
  // Distance in texels at which a texel's square may still touch the triangle: half a diagonal, plus room for rounding.
  constexpr double reach = 1.0;
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      if (!texels.opaque(x, y)) continue;
      const Vec2 centre(x + 0.5, y + 0.5);
      if (std::all_of(edges.begin(), edges.end(),
                      [&](const Edge& e) { return e.normal.dot(centre) + e.offset >= -reach; }))
        return true;
    }
  return false;
}

}  // namespace

std::vector<std::uint8_t> faces_with_opaque_texels(const TextureSet& set) {
  const Soup& soup = set.soup;
  const double width = set.texels->width(), height = set.texels->height();
  std::vector<std::uint8_t> flags(soup.faces().size());
  tbb::parallel_for(std::size_t{0}, flags.size(), [&](std::size_t f) {
    std::array<Vec2, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2& uv = soup.uvs()[soup.faces()[f][k]];
      corners[k] = {uv.x() * width, (1 - uv.y()) * height};
    }
    flags[f] = shows_opaque(*set.texels, corners) ? 1 : 0;
  });
  return flags;
}

}  // namespace rebake
