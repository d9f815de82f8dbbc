#include "mesh_ops/select/region.h"

#include <tbb/parallel_for.h>

#include "mesh_ops/base/union_find.h"
#include "mesh_ops/index/index.h"

namespace rebake {

namespace {

Vec3 centre(const Soup& soup, const Face& face) {
  return (soup.positions()[face[0]] + soup.positions()[face[1]] + soup.positions()[face[2]]) / 3;
}

}  // namespace

TriangleSet triangles_by_centre(const BakedObject& object, const std::function<bool(const Vec3&)>& inside) {
  TriangleSet flags(object.triangle_count(), 0);
  std::size_t first = 0;
  for (const TextureSet& set : object.sets) {
    const Soup& soup = set.soup;
    tbb::parallel_for(std::size_t{0}, soup.triangle_count(),
                      [&](std::size_t f) { flags[first + f] = inside(centre(soup, soup.faces()[f])) ? 1 : 0; });
    first += soup.triangle_count();
  }
  return flags;
}

TriangleSet triangles_connected(const BakedObject& object, std::size_t triangle) {
  const auto corners = corners_of(object);
  UnionFind parts(corners->place_count);
  TriangleSet flags(object.triangle_count(), 0);
  const std::vector<std::uint32_t>& places = corners->places;
  for (std::size_t t = 0; t < flags.size(); ++t)
    for (std::size_t k = 1; k < 3; ++k) parts.join(places[t * 3], places[t * 3 + k]);
  const std::uint32_t wanted = parts.root(places.at(triangle * 3));
  for (std::size_t t = 0; t < flags.size(); ++t) flags[t] = parts.root(places[t * 3]) == wanted ? 1 : 0;
  return flags;
}

}  // namespace rebake
