#include "mesh_ops/index/components.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numeric>
#include <span>

#include "mesh_ops/index/footprint.h"
#include "mesh_ops/index/near_points.h"

namespace rebake {

namespace {

// Opacity at 32 places along the edge from a to b, in texel coordinates; `inside` is the triangle's third corner. Bit i
// is set if the texel at place i is opaque.
std::uint32_t opaque_along(const FeatureTexture& texels, const Vec2& a, const Vec2& b, const Vec2& inside) {
  constexpr int places = 32;
  // Places lie up to a quarter of a texel inside the edge, so that rounding cannot reach a neighbouring patch.
  const Vec2 along = b - a;
  const Vec2 off = inside - a - along * (along.squaredNorm() > 0 ? (inside - a).dot(along) / along.squaredNorm() : 0.0);
  const double distance = off.norm();
  const Vec2 shift = distance > 0 ? Vec2(off * (std::min(0.25, distance / 2) / distance)) : Vec2(0, 0);
  const Vec2 first = a + shift + along * (0.5 / places), step = along / places;
  const double right = texels.width() - 1.0, bottom = texels.height() - 1.0;
  std::uint32_t mask = 0;
  bool opaque = false;
  int x = -1, y = -1;
  for (int i = 0; i < places; ++i) {
    const int next_x = static_cast<int>(std::clamp(first.x() + i * step.x(), 0.0, right));
    const int next_y = static_cast<int>(std::clamp(first.y() + i * step.y(), 0.0, bottom));
    if (next_x != x || next_y != y) opaque = texels.opaque(x = next_x, y = next_y);
    mask |= opaque ? 1U << i : 0U;
  }
  return mask;
}

// Appends the opaque places of an edge (bits as in opaque_along()), including its ends. Their spacing is at most
// `pitch` if 32 places allow it.
void add_edge_points(const Vec3& a, const Vec3& b, std::uint32_t opaque, double pitch, std::vector<Vec3>& points) {
  constexpr std::uint32_t places = 32;
  const double apart = (b - a).norm() / places;
  const auto stride =
      static_cast<std::uint32_t>(apart > 0 ? std::clamp(pitch / apart, 1.0, places - 1.0) : places - 1.0);
  for (std::uint32_t i = 0; i < places; i = i + stride < places - 1 || i == places - 1 ? i + stride : places - 1) {
    if ((opaque >> i & 1U) == 0) continue;
    const double share = i == 0 ? 0 : i == places - 1 ? 1 : (i + 0.5) / places;
    points.push_back(a + share * (b - a));
  }
}

// Sample points on the opaque texels of every triangle, and the triangle that owns each. The spacing is at most a
// quarter of the gap. Points are texel centres inside the triangle, and places along its edges, which may lie half a
// texel farther out.
void opaque_points(const BakedObject& object, const std::vector<std::shared_ptr<const EdgeOpacity>>& opacity,
                   double gap, std::vector<Vec3>& points, std::vector<std::uint32_t>& owner) {
  std::uint32_t triangle = 0;
  for (std::size_t s = 0; s < object.sets.size(); ++s) {
    const TextureSet& set = object.sets[s];
    for (std::size_t f = 0; f < set.soup.triangle_count(); ++f, ++triangle) {
      for (std::size_t k = 0; k < 3; ++k)
        add_edge_points(set.soup.positions()[set.soup.faces()[f][k]],
                        set.soup.positions()[set.soup.faces()[f][(k + 1) % 3]], opacity[s]->along[f * 3 + k], gap / 4,
                        points);
      owner.resize(points.size(), triangle);
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
        if (x % pitch != 0 || y % pitch != 0 || !set.texels->opaque(x, y)) return;
        const Vec3 w = barycentric(uv, {x + 0.5, y + 0.5});
        points.push_back(p[face[0]] * w[0] + p[face[1]] * w[1] + p[face[2]] * w[2]);
        owner.push_back(triangle);
      });
    }
  }
}

std::uint32_t reversed(std::uint32_t bits) {
  bits = (bits & 0x55555555U) << 1 | (bits >> 1 & 0x55555555U);
  bits = (bits & 0x33333333U) << 2 | (bits >> 2 & 0x33333333U);
  bits = (bits & 0x0f0f0f0fU) << 4 | (bits >> 4 & 0x0f0f0f0fU);
  bits = (bits & 0x00ff00ffU) << 8 | (bits >> 8 & 0x00ff00ffU);
  return bits << 16 | bits >> 16;
}

std::uint32_t end_of(const WeldedCorners& corners, std::size_t half_edge) {
  return corners.places[half_edge - half_edge % 3 + (half_edge + 1) % 3];
}

// Opacity along a half edge, ordered from its lower place number to its higher one.
std::uint32_t upwards(const WeldedCorners& corners, std::size_t half_edge, std::uint32_t along) {
  return corners.places[half_edge] <= end_of(corners, half_edge) ? along : reversed(along);
}

// Joins triangles across one edge: at each place, all opaque ones are joined to the first. They are not compared in
// pairs, because a large tolerance can put hundreds of triangles on one edge.
template <class Opaque, class Part>
void join_along(std::span<const std::uint32_t> half_edges, Opaque opaque, Part part, UnionFind& parts) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::array<std::uint32_t, 32> first_at;
  first_at.fill(none);
  for (const std::uint32_t e : half_edges) {
    const std::uint32_t own = part(e);
    std::uint32_t joined = none;
    for (std::uint32_t bits = opaque(e); bits != 0; bits &= bits - 1) {
      std::uint32_t& here = first_at[static_cast<std::size_t>(std::countr_zero(bits))];
      if (here == none)
        here = own;
      else if (here != joined)
        parts.join(joined = here, own);
    }
  }
}

template <class Visit>
void for_each_edge(const EdgeTable& edges, Visit visit) {
  for (std::size_t edge = 0; edge + 1 < edges.first_of.size(); ++edge)
    visit(std::span(edges.half_edges).subspan(edges.first_of[edge], edges.first_of[edge + 1] - edges.first_of[edge]));
}

// Renumbers components by their first triangles. `part_of`: element of `parts` per triangle.
Components numbered(const std::vector<std::uint32_t>& part_of, UnionFind& parts) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  Components result;
  result.part_of.resize(part_of.size());
  std::vector<std::uint32_t> number(part_of.size(), none);
  for (std::size_t t = 0; t < part_of.size(); ++t) {
    std::uint32_t& own = number[parts.root(part_of[t])];
    if (own == none) {
      own = static_cast<std::uint32_t>(result.triangles_in.size());
      result.triangles_in.push_back(0);
    }
    result.part_of[t] = own;
    ++result.triangles_in[own];
  }
  return result;
}

}  // namespace

EdgeOpacity edge_opacity(const TextureSet& set) {
  EdgeOpacity opacity{std::vector<std::uint32_t>(set.soup.triangle_count() * 3)};
  tbb::parallel_for(std::size_t{0}, set.soup.triangle_count(), [&](std::size_t f) {
    const std::array<Vec2, 3> uv = texel_corners(set, f);
    for (std::size_t k = 0; k < 3; ++k) {
      // Sampled from the same end for both triangles of an edge, so that rounding is the same.
      const Vec2 &a = uv[k], &b = uv[(k + 1) % 3], &inside = uv[(k + 2) % 3];
      const bool forward = std::pair(a.x(), a.y()) <= std::pair(b.x(), b.y());
      opacity.along[f * 3 + k] =
          forward ? opaque_along(*set.texels, a, b, inside) : reversed(opaque_along(*set.texels, b, a, inside));
    }
  });
  return opacity;
}

SetComponents set_components(const WeldedCorners& corners, const EdgeTable& edges, const EdgeOpacity& opacity) {
  UnionFind parts(corners.places.size() / 3);
  for_each_edge(edges, [&](std::span<const std::uint32_t> half_edges) {
    if (half_edges.size() > 1)
      join_along(
          half_edges, [&](std::uint32_t e) { return upwards(corners, e, opacity.along[e]); },
          [](std::uint32_t e) { return e / 3; }, parts);
  });
  SetComponents result;
  result.part_of.resize(corners.places.size() / 3);
  for (std::uint32_t t = 0; t < result.part_of.size(); ++t) {
    const std::uint32_t root = parts.root(t);
    result.part_of[t] = root == t ? result.count++ : result.part_of[root];
  }
  return result;
}

Components joined_components(const WeldedCorners& corners, const std::vector<IndexedSet>& sets) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max(), shared = none - 1;
  std::vector<std::uint32_t> set_of(corners.place_count, none), part_of(corners.places.size() / 3);
  std::vector<std::size_t> first{0};
  std::uint32_t count = 0;
  bool any_shared = false;
  for (std::uint32_t s = 0; s < sets.size(); ++s) {
    const std::vector<std::uint32_t>& own = sets[s].parts->part_of;
    for (std::size_t t = 0; t < own.size(); ++t) part_of[first[s] + t] = count + own[t];
    count += sets[s].parts->count;
    first.push_back(first[s] + own.size());
    for (std::size_t corner = 3 * first[s]; corner < 3 * first[s + 1]; ++corner) {
      std::uint32_t& of = set_of[corners.places[corner]];
      any_shared = any_shared || (of != none && of != s);
      of = of == none || of == s ? s : shared;
    }
  }
  UnionFind parts(count);
  if (any_shared) {
    std::vector<std::uint32_t> half_edges;
    for (std::uint32_t e = 0; e < corners.places.size(); ++e)
      if (set_of[corners.places[e]] == shared && set_of[end_of(corners, e)] == shared) half_edges.push_back(e);
    const auto key = [&](std::uint32_t e) {
      const std::uint32_t from = corners.places[e], to = end_of(corners, e);
      return std::pair(std::min(from, to), std::max(from, to));
    };
    std::sort(half_edges.begin(), half_edges.end(),
              [&](std::uint32_t a, std::uint32_t b) { return std::pair(key(a), a) < std::pair(key(b), b); });
    for (std::size_t begin = 0, end = 0; begin < half_edges.size(); begin = end) {
      while (end < half_edges.size() && key(half_edges[end]) == key(half_edges[begin])) ++end;
      join_along(
          std::span(half_edges).subspan(begin, end - begin),
          [&](std::uint32_t e) {
            const auto s =
                static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), e / 3) - first.begin()) - 1;
            return upwards(corners, e, sets[s].opacity->along[e - 3 * first[s]]);
          },
          [&](std::uint32_t e) { return part_of[e / 3]; }, parts);
    }
  }
  return numbered(part_of, parts);
}

Components opaque_components(const BakedObject& object, const WeldedCorners& corners, const EdgeTable& edges,
                             const std::vector<std::shared_ptr<const EdgeOpacity>>& opacity, double gap) {
  const std::size_t total = object.triangle_count();
  std::vector<std::uint32_t> opaque(total * 3);  // per half edge, from its lower place to its higher one
  std::size_t first = 0;
  for (const auto& set : opacity) {
    tbb::parallel_for(std::size_t{0}, set->along.size(),
                      [&](std::size_t e) { opaque[first + e] = upwards(corners, first + e, set->along[e]); });
    first += set->along.size();
  }
  UnionFind parts(total);
  for_each_edge(edges, [&](std::span<const std::uint32_t> half_edges) {
    join_along(
        half_edges, [&](std::uint32_t e) { return opaque[e]; }, [](std::uint32_t e) { return e / 3; }, parts);
  });
  if (gap > 0) {
    std::vector<Vec3> points;
    std::vector<std::uint32_t> owner;
    opaque_points(object, opacity, gap, points, owner);
    if (!points.empty()) join_near(parts, points, owner, gap, object.bounds().min());
  }
  std::vector<std::uint32_t> own(total);
  std::iota(own.begin(), own.end(), 0U);
  return numbered(own, parts);
}

}  // namespace rebake
