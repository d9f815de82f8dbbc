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
  const FeatureTexture* texels;
  bool operator==(const Key&) const = default;
};

struct KeyHash {
  std::size_t operator()(const Key& key) const {
    return std::hash<std::string_view>{}({reinterpret_cast<const char*>(&key.corners), sizeof(key.corners)}) ^
           std::hash<const void*>{}(key.texels);
  }
};

Corner corner_of(const Soup& soup, std::uint32_t vertex) {
  const Vec3& p = soup.positions()[vertex];
  const Vec2& uv = soup.uvs()[vertex];
  // Adding 0.0 makes −0 and 0 equal.
  const auto bits = [](double v) { return std::bit_cast<std::uint64_t>(v + 0.0); };
  return {bits(p.x()), bits(p.y()), bits(p.z()), bits(uv.x()), bits(uv.y())};
}

}  // namespace

TriangleSet duplicate_triangles(const BakedObject& object) {
  TriangleSet flags(object.triangle_count(), 0);
  std::unordered_set<Key, KeyHash> later;
  later.reserve(flags.size());
  std::size_t f = flags.size();
  for (auto set = object.sets.rbegin(); set != object.sets.rend(); ++set) {
    const std::vector<Face>& faces = set->soup.faces();
    for (auto face = faces.rbegin(); face != faces.rend(); ++face) {
      Key key{{corner_of(set->soup, (*face)[0]), corner_of(set->soup, (*face)[1]), corner_of(set->soup, (*face)[2])},
              set->texels.get()};
      std::sort(key.corners.begin(), key.corners.end());
      flags[--f] = later.insert(key).second ? 0 : 1;
    }
  }
  return flags;
}

}  // namespace rebake
