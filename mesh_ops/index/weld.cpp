#include "mesh_ops/index/weld.h"

#include <array>
#include <bit>
#include <numeric>

#include "mesh_ops/index/near_points.h"
#include "mesh_ops/index/numbering.h"

namespace rebake {

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

}  // namespace rebake
