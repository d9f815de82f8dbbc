#include "mesh_ops/select/region.h"

#include <tbb/parallel_for.h>

#include <array>
#include <bit>
#include <limits>
#include <numeric>
#include <unordered_map>

namespace rebake {

namespace {

Vec3 centre(const Soup& soup, const Face& face) {
  return (soup.positions()[face[0]] + soup.positions()[face[1]] + soup.positions()[face[2]]) / 3;
}

using Key = std::array<std::uint64_t, 3>;

struct KeyHash {
  std::size_t operator()(const Key& key) const {
    std::uint64_t h = 0;
    for (const std::uint64_t part : key) h = (h ^ part) * 0x9E3779B97F4A7C15ULL, h ^= h >> 29;
    return h;
  }
};

Key key_of(const Vec3& p) {
  // −0 and 0 are one place.
  return {std::bit_cast<std::uint64_t>(p.x() + 0.0), std::bit_cast<std::uint64_t>(p.y() + 0.0),
          std::bit_cast<std::uint64_t>(p.z() + 0.0)};
}

}  // namespace

TriangleSet triangles_by_centre(const BakedObject& object, const Affine& transform,
                                const std::function<bool(const Vec3&)>& inside) {
  TriangleSet flags(object.triangle_count(), 0);
  std::size_t first = 0;
  for (const TextureSet& set : object.sets) {
    const Soup& soup = set.soup;
    tbb::parallel_for(std::size_t{0}, soup.triangle_count(), [&](std::size_t f) {
      flags[first + f] = inside(transform * centre(soup, soup.faces()[f])) ? 1 : 0;
    });
    first += soup.triangle_count();
  }
  return flags;
}

TriangleSet triangles_connected(const BakedObject& object, const Vec3& point) {
  const std::size_t total = object.triangle_count();
  TriangleSet flags(total, 0);
  std::unordered_map<Key, std::uint32_t, KeyHash> welded;
  std::vector<std::uint32_t> corner;
  corner.reserve(total * 3);
  std::size_t nearest = 0, f = 0;
  double least = std::numeric_limits<double>::infinity();
  for (const TextureSet& set : object.sets) {
    for (const Face& face : set.soup.faces()) {
      for (const std::uint32_t vertex : face)
        corner.push_back(
            welded.try_emplace(key_of(set.soup.positions()[vertex]), static_cast<std::uint32_t>(welded.size()))
                .first->second);
      const double distance = (centre(set.soup, face) - point).squaredNorm();
      if (distance < least) {
        least = distance;
        nearest = f;
      }
      ++f;
    }
  }
  std::vector<std::uint32_t> parent(welded.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (std::size_t t = 0; t < total; ++t)
    for (std::size_t k = 1; k < 3; ++k) parent[root(corner[t * 3 + k])] = root(corner[t * 3]);
  if (total == 0) return flags;
  const std::uint32_t wanted = root(corner[nearest * 3]);
  for (std::size_t t = 0; t < total; ++t) flags[t] = root(corner[t * 3]) == wanted ? 1 : 0;
  return flags;
}

}  // namespace rebake
