#include "mesh_ops/index/weld.h"

#include <array>
#include <bit>
#include <numeric>

#include "mesh_ops/index/near_points.h"
#include "mesh_ops/index/numbering.h"

namespace rebake {

namespace {

using Key = std::array<std::uint64_t, 3>;
struct KeyHash {
  std::size_t operator()(const Key& key) const { return mixed(key[0], key[1], key[2]); }
};
using Places = Numbering<Key, KeyHash>;

// Adding 0.0 makes −0 and 0 one place.
Key key_of(const Vec3& p) {
  return {std::bit_cast<std::uint64_t>(p.x() + 0.0), std::bit_cast<std::uint64_t>(p.y() + 0.0),
          std::bit_cast<std::uint64_t>(p.z() + 0.0)};
}
Vec3 point_of(const Key& key) {
  return {std::bit_cast<double>(key[0]), std::bit_cast<double>(key[1]), std::bit_cast<double>(key[2])};
}

}  // namespace

WeldedSet weld_set(const Soup& soup) {
  WeldedSet welded;
  welded.corners.places.resize(soup.triangle_count() * 3);
  Places numbers(soup.positions().size(), {});
  std::vector<std::uint32_t> place(soup.positions().size(), Places::empty);
  std::size_t corner = 0;
  for (const Face& face : soup.faces())
    for (const std::uint32_t vertex : face) {
      if (place[vertex] == Places::empty) place[vertex] = numbers.number(key_of(soup.positions()[vertex]));
      welded.corners.places[corner++] = place[vertex];
    }
  welded.corners.place_count = static_cast<std::uint32_t>(numbers.keys().size());
  for (const Key& key : numbers.keys()) welded.points.push_back(point_of(key));
  return welded;
}

WeldedCorners weld(const BakedObject& object, const std::vector<std::shared_ptr<const WeldedSet>>& sets,
                   double tolerance) {
  WeldedCorners welded;
  welded.places.resize(object.triangle_count() * 3);
  std::size_t most = 0;
  for (const auto& set : sets) most += set->points.size();
  Places numbers(most, {});
  std::size_t corner = 0;
  for (const auto& set : sets) {
    std::vector<std::uint32_t> number;
    for (const Vec3& point : set->points) number.push_back(numbers.number(key_of(point)));
    for (const std::uint32_t place : set->corners.places) welded.places[corner++] = number[place];
  }
  welded.place_count = static_cast<std::uint32_t>(numbers.keys().size());
  if (!(tolerance > 0)) return welded;
  std::vector<Vec3> points(welded.place_count);
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = point_of(numbers.keys()[i]);
  std::vector<std::uint32_t> own(points.size());
  std::iota(own.begin(), own.end(), 0U);
  UnionFind joined(points.size());
  join_near(joined, points, own, tolerance, object.bounds().min());
  std::vector<std::uint32_t> renumbered(points.size(), Places::empty);
  welded.place_count = 0;
  for (std::uint32_t& place : welded.places) {
    std::uint32_t& number = renumbered[joined.root(place)];
    if (number == Places::empty) number = welded.place_count++;
    place = number;
  }
  return welded;
}

}  // namespace rebake
