#include "mesh_ops/index/connection.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "mesh_ops/base/union_find.h"
#include "mesh_ops/index/footprint.h"

namespace rebake {

namespace {

std::uint64_t mixed(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  std::uint64_t h = a * 0x9E3779B97F4A7C15ULL;
  h = (h ^ (h >> 29) ^ b) * 0xBF58476D1CE4E5B9ULL;
  h = (h ^ (h >> 31) ^ c) * 0x94D049BB133111EBULL;
  return h ^ (h >> 30);
}

// Numbers of equal keys: a flat hash table, since millions of corners go through it.
template <class Key, class Hash>
class Numbering {
 public:
  Numbering(std::size_t most, Hash hash)
      : slots_(std::bit_ceil(most * 2 + 2), empty), hash_(hash), mask_(slots_.size() - 1) {}
  std::uint32_t number(const Key& key) {
    for (std::size_t slot = hash_(key) & mask_;; slot = (slot + 1) & mask_) {
      if (slots_[slot] == empty) {
        slots_[slot] = static_cast<std::uint32_t>(keys_.size());
        keys_.push_back(key);
        return slots_[slot];
      }
      if (keys_[slots_[slot]] == key) return slots_[slot];
    }
  }
  // `empty` where there is none.
  std::uint32_t find(const Key& key) const {
    for (std::size_t slot = hash_(key) & mask_;; slot = (slot + 1) & mask_)
      if (slots_[slot] == empty || keys_[slots_[slot]] == key) return slots_[slot];
  }
  const std::vector<Key>& keys() const { return keys_; }
  static constexpr std::uint32_t empty = std::numeric_limits<std::uint32_t>::max();

 private:
  std::vector<std::uint32_t> slots_;
  std::vector<Key> keys_;
  Hash hash_;
  std::size_t mask_;
};

using Cell = std::array<std::int64_t, 3>;
std::uint64_t hash_cell(const Cell& cell) {
  return mixed(static_cast<std::uint64_t>(cell[0]), static_cast<std::uint64_t>(cell[1]),
               static_cast<std::uint64_t>(cell[2]));
}
Cell cell_of(const Vec3& p, const Vec3& origin, double size) {
  const Vec3 at = (p - origin) / size;
  const auto whole = [](double x) { return static_cast<std::int64_t>(std::floor(x)); };
  return {whole(at.x()), whole(at.y()), whole(at.z())};
}

// Joins points that are at most `reach` apart, by their numbers in `owner`.
void join_near(UnionFind& parts, const std::vector<Vec3>& points, const std::vector<std::uint32_t>& owner, double reach,
               const Vec3& origin) {
  // Below the rounding of the points themselves, a reach means nothing (and cells could not be counted).
  double extent = 0;
  for (const Vec3& p : points) extent = std::max(extent, (p - origin).cwiseAbs().maxCoeff());
  if (!(reach > extent * 1e-15) || !std::isfinite(reach)) return;
  // Points of one cell are within reach of each other, so only neighbours need comparing.
  const double size = reach / std::sqrt(3.0);
  Numbering<Cell, decltype(&hash_cell)> cells(points.size(), &hash_cell);
  std::vector<std::uint32_t> cell(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) cell[i] = cells.number(cell_of(points[i], origin, size));
  const std::size_t count = cells.keys().size();
  std::vector<std::uint32_t> begin(count + 1, 0), order(points.size());
  for (const std::uint32_t c : cell) ++begin[c + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> at(begin.begin(), begin.end() - 1);
  for (std::uint32_t i = 0; i < points.size(); ++i) order[at[cell[i]]++] = i;
  for (std::uint32_t c = 0; c < count; ++c) {
    const std::uint32_t first = owner[order[begin[c]]];
    for (std::uint32_t i = begin[c] + 1; i < begin[c + 1]; ++i) parts.join(first, owner[order[i]]);
  }
  for (std::uint32_t c = 0; c < count; ++c) {
    const Cell& here = cells.keys()[c];
    for (std::int64_t dz = -2; dz <= 2; ++dz)
      for (std::int64_t dy = -2; dy <= 2; ++dy)
        for (std::int64_t dx = -2; dx <= 2; ++dx) {
          if (std::tie(dz, dy, dx) <= std::tuple<std::int64_t, std::int64_t, std::int64_t>(0, 0, 0)) continue;
          const std::uint32_t there = cells.find({here[0] + dx, here[1] + dy, here[2] + dz});
          if (there == decltype(cells)::empty) continue;
          if (parts.root(owner[order[begin[c]]]) == parts.root(owner[order[begin[there]]])) continue;
          bool near = false;
          for (std::uint32_t i = begin[c]; i < begin[c + 1] && !near; ++i)
            for (std::uint32_t j = begin[there]; j < begin[there + 1] && !near; ++j)
              near = (points[order[i]] - points[order[j]]).squaredNorm() <= reach * reach;
          if (near) parts.join(owner[order[begin[c]]], owner[order[begin[there]]]);
        }
  }
}

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

WeldedCorners weld(const BakedObject& object, double tolerance) {
  WeldedCorners welded;
  welded.places.resize(object.triangle_count() * 3);
  using Key = std::array<std::uint64_t, 3>;
  const auto hash = [](const Key& key) { return mixed(key[0], key[1], key[2]); };
  Numbering<Key, decltype(hash)> numbers(object.vertex_count(), hash);
  std::size_t corner = 0;
  for (const TextureSet& set : object.sets) {
    std::vector<std::uint32_t> place(set.soup.positions().size(), decltype(numbers)::empty);
    for (const Face& face : set.soup.faces())
      for (const std::uint32_t vertex : face) {
        if (place[vertex] == decltype(numbers)::empty) {
          const Vec3& p = set.soup.positions()[vertex];
          // −0 and 0 are one place.
          place[vertex] =
              numbers.number({std::bit_cast<std::uint64_t>(p.x() + 0.0), std::bit_cast<std::uint64_t>(p.y() + 0.0),
                              std::bit_cast<std::uint64_t>(p.z() + 0.0)});
        }
        welded.places[corner++] = place[vertex];
      }
  }
  welded.place_count = static_cast<std::uint32_t>(numbers.keys().size());
  if (!(tolerance > 0)) return welded;
  std::vector<Vec3> points(welded.place_count);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int k = 0; k < 3; ++k) points[i][k] = std::bit_cast<double>(numbers.keys()[i][static_cast<std::size_t>(k)]);
  std::vector<std::uint32_t> own(points.size());
  std::iota(own.begin(), own.end(), 0U);
  UnionFind joined(points.size());
  join_near(joined, points, own, tolerance, object.bounds().min());
  std::vector<std::uint32_t> renumbered(points.size(), decltype(numbers)::empty);
  welded.place_count = 0;
  for (std::uint32_t& place : welded.places) {
    std::uint32_t& number = renumbered[joined.root(place)];
    if (number == decltype(numbers)::empty) number = welded.place_count++;
    place = number;
  }
  return welded;
}

EdgeTable edges_between(const WeldedCorners& corners) {
  const std::vector<std::uint32_t>& places = corners.places;
  const auto end_of = [&](std::size_t half_edge) { return places[half_edge - half_edge % 3 + (half_edge + 1) % 3]; };
  const auto low = [&](std::size_t e) { return std::min(places[e], end_of(e)); };
  const auto high = [&](std::size_t e) { return std::max(places[e], end_of(e)); };
  // By the lower place, as a counting sort; the few of each place then by the higher one.
  std::vector<std::uint32_t> begin(corners.place_count + 1U, 0);
  for (std::size_t e = 0; e < places.size(); ++e) ++begin[low(e) + 1U];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  EdgeTable table;
  table.half_edges.resize(places.size());
  std::vector<std::uint32_t> at(begin.begin(), begin.end() - 1);
  for (std::uint32_t e = 0; e < places.size(); ++e) table.half_edges[at[low(e)]++] = e;
  tbb::parallel_for(std::size_t{0}, static_cast<std::size_t>(corners.place_count), [&](std::size_t place) {
    std::sort(table.half_edges.begin() + begin[place], table.half_edges.begin() + begin[place + 1],
              [&](std::uint32_t a, std::uint32_t b) { return std::pair(high(a), a) < std::pair(high(b), b); });
  });
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    const std::uint32_t e = table.half_edges[i];
    if (i == 0 || low(e) != low(table.half_edges[i - 1]) || high(e) != high(table.half_edges[i - 1]))
      table.first_of.push_back(i);
  }
  table.first_of.push_back(static_cast<std::uint32_t>(places.size()));
  return table;
}

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

TriangleSet grown(const WeldedCorners& corners, const TriangleSet& selection) {
  std::vector<std::uint8_t> touched(corners.place_count, 0);
  for (std::size_t t = 0; t < selection.size(); ++t)
    if (selection[t] != 0)
      for (std::size_t k = 0; k < 3; ++k) touched[corners.places[t * 3 + k]] = 1;
  TriangleSet result(selection.size(), 0);
  for (std::size_t t = 0; t < selection.size(); ++t)
    result[t] =
        touched[corners.places[t * 3]] | touched[corners.places[t * 3 + 1]] | touched[corners.places[t * 3 + 2]];
  return result;
}

TriangleSet shrunk(const WeldedCorners& corners, const TriangleSet& selection) {
  TriangleSet outside(selection.size());
  for (std::size_t t = 0; t < selection.size(); ++t) outside[t] = selection[t] != 0 ? 0 : 1;
  TriangleSet result = grown(corners, outside);
  for (auto& flag : result) flag = flag != 0 ? 0 : 1;
  return result;
}

TriangleSet filled(const EdgeTable& edges, const TriangleSet& selection, std::size_t largest) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  UnionFind islands(selection.size());
  std::vector<std::uint32_t> beside;  // unselected triangles that share an edge with a selected one
  for (std::size_t edge = 0; edge + 1 < edges.first_of.size(); ++edge) {
    bool borders = false;
    std::uint32_t open = none;
    for (std::uint32_t i = edges.first_of[edge]; i < edges.first_of[edge + 1]; ++i) {
      const std::uint32_t t = edges.half_edges[i] / 3;
      if (selection[t] != 0)
        borders = true;
      else if (open == none)
        open = t;
      else
        islands.join(open, t);
    }
    if (borders && open != none) beside.push_back(open);
  }
  std::vector<std::uint32_t> size(selection.size(), 0);
  std::vector<std::uint8_t> borders(selection.size(), 0);
  for (std::uint32_t t = 0; t < selection.size(); ++t)
    if (selection[t] == 0) ++size[islands.root(t)];
  for (const std::uint32_t t : beside) borders[islands.root(t)] = 1;
  TriangleSet result = selection;
  for (std::uint32_t t = 0; t < selection.size(); ++t) {
    const std::uint32_t root = islands.root(t);
    if (selection[t] == 0 && borders[root] != 0 && size[root] < largest) result[t] = 1;
  }
  return result;
}

}  // namespace rebake
