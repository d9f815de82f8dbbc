#include "mesh_ops/index/components.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "mesh_ops/index/footprint.h"
#include "mesh_ops/index/near_points.h"

namespace rebake {

namespace {

// Bit i is set when the texel beside the i-th of 32 places along an edge is opaque, counted from a to b.
std::uint32_t opaque_along(const FeatureTexture& texels, const Vec2& a, const Vec2& b, const Vec2& inside) {
  constexpr int places = 32;
  // A quarter of a texel off the edge, towards the inside, so that rounding cannot fall into a neighbouring patch.
  const Vec2 along = b - a;
  const Vec2 off = inside - a - along * (along.squaredNorm() > 0 ? (inside - a).dot(along) / along.squaredNorm() : 0.0);
  const double distance = off.norm();
  const Vec2 shift = distance > 0 ? Vec2(off * (std::min(0.25, distance / 2) / distance)) : Vec2(0, 0);
  const Vec2 first = a + shift + along * (0.5 / places), step = along / places;
  const double right = texels.width() - 1.0, bottom = texels.height() - 1.0;
  std::uint32_t mask = 0;
  const Texel* texel = nullptr;
  int x = -1, y = -1;
  for (int i = 0; i < places; ++i) {
    const int next_x = static_cast<int>(std::clamp(first.x() + i * step.x(), 0.0, right));
    const int next_y = static_cast<int>(std::clamp(first.y() + i * step.y(), 0.0, bottom));
    if (next_x != x || next_y != y) texel = &texels.at(x = next_x, y = next_y);
    mask |= texel->opaque() ? 1U << i : 0U;
  }
  return mask;
}

// Opaque texel centres of every triangle, at a pitch of at most a quarter of the gap.
void opaque_points(const BakedObject& object, double gap, std::vector<Vec3>& points,
                   std::vector<std::uint32_t>& owner) {
  std::uint32_t triangle = 0;
  for (const TextureSet& set : object.sets)
    for (std::size_t f = 0; f < set.soup.triangle_count(); ++f, ++triangle) {
      const std::array<Vec2, 3> uv = texel_corners(set, f);
      const Face& face = set.soup.faces()[f];
      const std::vector<Vec3>& p = set.soup.positions();
      double texel = 0;  // longest side of a texel in object units
      for (std::size_t k = 0; k < 3; ++k) {
        const double texels = (uv[(k + 1) % 3] - uv[k]).norm();
        if (texels > 0) texel = std::max(texel, (p[face[(k + 1) % 3]] - p[face[k]]).norm() / texels);
      }
      const int pitch = texel > 0 ? static_cast<int>(std::clamp(gap / 4 / texel, 1.0, 8.0)) : 1;
      for_each_texel_inside(uv, set.texels->width(), set.texels->height(), [&](int x, int y) {
        if (x % pitch != 0 || y % pitch != 0 || !set.texels->at(x, y).opaque()) return;
        const Vec3 w = barycentric(uv, {x + 0.5, y + 0.5});
        points.push_back(p[face[0]] * w[0] + p[face[1]] * w[1] + p[face[2]] * w[2]);
        owner.push_back(triangle);
      });
    }
}

}  // namespace

Components opaque_components(const BakedObject& object, const WeldedCorners& corners, const EdgeTable& edges,
                             double gap) {
  const std::size_t total = object.triangle_count();
  std::vector<std::uint32_t> opaque(total * 3);  // along each half edge, from the lower place to the higher
  std::size_t first = 0;
  for (const TextureSet& set : object.sets) {
    tbb::parallel_for(std::size_t{0}, set.soup.triangle_count(), [&](std::size_t f) {
      const std::array<Vec2, 3> uv = texel_corners(set, f);
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t e = (first + f) * 3 + k;
        const bool forward = corners.places[e] <= corners.places[(first + f) * 3 + (k + 1) % 3];
        const Vec2 &a = uv[k], &b = uv[(k + 1) % 3];
        opaque[e] = opaque_along(*set.texels, forward ? a : b, forward ? b : a, uv[(k + 2) % 3]);
      }
    });
    first += set.soup.triangle_count();
  }
  UnionFind parts(total);
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  for (std::size_t edge = 0; edge + 1 < edges.first_of.size(); ++edge) {
    // Who is opaque at a place of the edge hangs together with the first that is. A wide tolerance can lay hundreds of
    // triangles along one edge, so they are not compared in pairs.
    std::array<std::uint32_t, 32> first_at;
    first_at.fill(none);
    for (std::uint32_t i = edges.first_of[edge]; i < edges.first_of[edge + 1]; ++i) {
      const std::uint32_t triangle = edges.half_edges[i] / 3;
      std::uint32_t joined = none;
      for (std::uint32_t bits = opaque[edges.half_edges[i]]; bits != 0; bits &= bits - 1) {
        std::uint32_t& here = first_at[static_cast<std::size_t>(std::countr_zero(bits))];
        if (here == none)
          here = triangle;
        else if (here != joined)
          parts.join(joined = here, triangle);
      }
    }
  }
  if (gap > 0) {
    std::vector<Vec3> points;
    std::vector<std::uint32_t> owner;
    opaque_points(object, gap, points, owner);
    if (!points.empty()) join_near(parts, points, owner, gap, object.bounds().min());
  }
  Components result;
  result.part_of.resize(total);
  std::vector<std::uint32_t> number(total);
  for (std::uint32_t t = 0; t < total; ++t) {
    const std::uint32_t root = parts.root(t);
    if (root == t) {
      number[t] = static_cast<std::uint32_t>(result.triangles_in.size());
      result.triangles_in.push_back(0);
    }
    result.part_of[t] = number[root];
    ++result.triangles_in[number[root]];
  }
  return result;
}

}  // namespace rebake
