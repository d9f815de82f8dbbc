#include "mesh_ops/select/duplicates.h"

#include <algorithm>
#include <bit>
#include <string_view>
#include <unordered_set>

namespace rebake {

namespace {

using Corner = std::array<std::uint64_t, 5>;

struct Key {
  std::array<Corner, 3> corners;
  std::size_t texels;  // the first set with equal texels
  bool operator==(const Key&) const = default;
};

struct KeyHash {
  std::size_t operator()(const Key& key) const {
    return std::hash<std::string_view>{}({reinterpret_cast<const char*>(&key.corners), sizeof(key.corners)}) ^
           std::hash<std::size_t>{}(key.texels);
  }
};

Corner corner_of(const Soup& soup, std::uint32_t vertex) {
  const Vec3& p = soup.positions()[vertex];
  const Vec2& uv = soup.uvs()[vertex];
  // Adding 0.0 makes −0 and 0 equal.
  const auto bits = [](double v) { return std::bit_cast<std::uint64_t>(v + 0.0); };
  return {bits(p.x()), bits(p.y()), bits(p.z()), bits(uv.x()), bits(uv.y())};
}

bool equal_texels(const FeatureTexture& a, const FeatureTexture& b) {
  if (a.width() != b.width() || a.height() != b.height() || a.alpha_code() != b.alpha_code()) return false;
  for (int row = 0; row < a.tile_rows(); ++row)
    for (int column = 0; column < a.tile_columns(); ++column)
      if (a.tile(column, row) != b.tile(column, row) &&
          *a.tile(column, row)->texels() != *b.tile(column, row)->texels())
        return false;
  return true;
}

// Per texture set, the first one with equal texels.
std::vector<std::size_t> equal_sets(const BakedObject& object) {
  std::vector<std::size_t> firsts;
  for (std::size_t s = 0; s < object.sets.size(); ++s) {
    std::size_t first = 0;
    while (first < s && object.sets[first].texels != object.sets[s].texels &&
           (firsts[first] != first || !equal_texels(*object.sets[first].texels, *object.sets[s].texels)))
      ++first;
    firsts.push_back(first == s ? s : firsts[first]);
  }
  return firsts;
}

}  // namespace

TriangleSet duplicate_triangles(const BakedObject& object) {
  TriangleSet flags(object.triangle_count(), 0);
  std::unordered_set<Key, KeyHash> later;
  later.reserve(flags.size());
  std::size_t f = flags.size();
  const std::vector<std::size_t> firsts = equal_sets(object);
  for (std::size_t s = object.sets.size(); s-- > 0;) {
    const Soup& soup = object.sets[s].soup;
    for (auto face = soup.faces().rbegin(); face != soup.faces().rend(); ++face) {
      Key key{{corner_of(soup, (*face)[0]), corner_of(soup, (*face)[1]), corner_of(soup, (*face)[2])}, firsts[s]};
      std::sort(key.corners.begin(), key.corners.end());
      flags[--f] = later.insert(key).second ? 0 : 1;
    }
  }
  return flags;
}

}  // namespace rebake
