#include "mesh_ops/registration/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "mesh_ops/index/footprint.h"

namespace rebake {

namespace {

struct Triangle {
  const TextureSet* set;
  std::uint32_t node, number, face;  // indices of the placed node, of the set in it, and of the face
  std::array<Vec3, 3> corners;       // in world space
  double area;
};

std::vector<Triangle> triangles_of(const std::vector<PlacedNode>& nodes) {
  std::vector<Triangle> triangles;
  for (std::uint32_t n = 0; n < nodes.size(); ++n) {
    const PlacedNode& placed = nodes[n];
    if (!placed.visible || !placed.node->object) continue;
    for (std::uint32_t s = 0; s < placed.node->object->sets.size(); ++s) {
      const TextureSet& set = placed.node->object->sets[s];
      for (std::uint32_t f = 0; f < set.soup.triangle_count(); ++f) {
        const Face& face = set.soup.faces()[f];
        const auto corner = [&](std::size_t k) { return Vec3(placed.to_world * set.soup.positions()[face[k]]); };
        Triangle triangle{&set, n, s, f, {corner(0), corner(1), corner(2)}, 0};
        triangle.area =
            (triangle.corners[1] - triangle.corners[0]).cross(triangle.corners[2] - triangle.corners[0]).norm() / 2;
        if (triangle.area > 0 && std::isfinite(triangle.area)) triangles.push_back(triangle);
      }
    }
  }
  return triangles;
}

}  // namespace

SurfaceSamples sampled_surfaces(const std::vector<PlacedNode>& nodes, std::size_t count, std::uint64_t seed) {
  const std::vector<Triangle> triangles = triangles_of(nodes);
  double area = 0;
  for (const Triangle& triangle : triangles) area += triangle.area;
  SurfaceSamples samples;
  std::mt19937_64 random(seed);
  const auto share = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  // Stratified along the triangles: one sample per equal part of the area. Transparent places take none, so a second
  // round fills up.
  for (std::size_t wanted = count, round = 0; round < 2 && area > 0 && wanted > 0; ++round) {
    const double step = area / static_cast<double>(wanted);
    double next = share() * step, passed = 0;
    for (const Triangle& triangle : triangles) {
      passed += triangle.area;
      while (next < passed) {
        next += step;
        double u = share(), v = share();
        if (u + v > 1) u = 1 - u, v = 1 - v;
        const std::array<Vec2, 3> texels = texel_corners(*triangle.set, triangle.face);
        const Vec2 at = texels[0] * (1 - u - v) + texels[1] * u + texels[2] * v;
        const FeatureTexture& texture = *triangle.set->texels;
        if (!at.allFinite()) continue;
        const int x = texel_within(at.x(), texture.width()), y = texel_within(at.y(), texture.height());
        if (!texture.opaque(x, y)) continue;
        const auto& p = triangle.corners;
        samples.points.push_back(p[0] + u * (p[1] - p[0]) + v * (p[2] - p[0]));
        samples.normals.push_back((p[1] - p[0]).cross(p[2] - p[0]).stableNormalized());
        samples.places.push_back({triangle.node, triangle.number, triangle.face, x, y});
      }
    }
    const std::size_t found = samples.points.size();
    if (found == 0 || found >= count) break;
    // As many as are missing, at the share that hit so far.
    wanted = static_cast<std::size_t>(static_cast<double>(count - found) * static_cast<double>(wanted) /
                                      static_cast<double>(found));
    wanted = std::min(wanted, 20 * count);
  }
  return samples;
}

}  // namespace rebake
