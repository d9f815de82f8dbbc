#include "mesh_ops/light/transport/occluder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "mesh_ops/base/hash.h"
#include "mesh_ops/index/array_cache.h"
#include "mesh_ops/index/index.h"

namespace rebake {

struct SurfaceHash {
  std::uint64_t hash;
};
struct Reach {
  double distance;
};
static std::uint64_t memory_of(const SurfaceHash&) { return sizeof(SurfaceHash); }
static std::uint64_t memory_of(const Reach&) { return sizeof(Reach); }

namespace {

// Per-object results: in a scene of many objects, each occludes all the others.
ArrayCache& cache() {
  static ArrayCache cache(std::uint64_t{1} << 20);
  return cache;
}

ArrayCache::Arrays arrays_of(const BakedObject& object) {
  ArrayCache::Arrays arrays;
  for (const TextureSet& set : object.sets) {
    arrays.push_back(set.soup.shared_positions());
    arrays.push_back(set.soup.shared_uvs());
    arrays.push_back(set.soup.shared_faces());
    arrays.push_back(set.texels);
  }
  return arrays;
}

// Ray length beyond which the object does not occlude: three times the distance of most triangles from their median, if
// some are much farther away (a backdrop); else infinite.
double found_reach(const BakedObject& object) {
  std::vector<Vec3> centers;
  for (const TextureSet& set : object.sets)
    for (const Face& face : set.soup.faces())
      centers.push_back(
          (set.soup.positions()[face[0]] + set.soup.positions()[face[1]] + set.soup.positions()[face[2]]) / 3);
  if (centers.empty()) return std::numeric_limits<double>::infinity();
  const auto quantile = [](std::vector<double>& values, double share) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  Vec3 middle;
  std::vector<double> values(centers.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(centers.begin(), centers.end(), values.begin(), [&](const Vec3& p) { return p[axis]; });
    middle[axis] = quantile(values, 0.5);
  }
  std::transform(centers.begin(), centers.end(), values.begin(), [&](const Vec3& p) { return (p - middle).norm(); });
  const double most = quantile(values, 0.6), all = *std::max_element(values.begin(), values.end());
  constexpr double far = 3;
  return all > 1.2 * far * most ? far * most : std::numeric_limits<double>::infinity();
}

std::uint64_t found_hash(const BakedObject& object) {
  std::vector<std::uint64_t> hashes;
  const auto view = [](const auto& values) {
    return std::string_view(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
  };
  const auto add = [&](const auto& values) { hashes.push_back(content_hash(view(values))); };
  for (const TextureSet& set : object.sets) {
    add(set.soup.positions());
    add(set.soup.uvs());
    add(set.soup.faces());
    add(std::array<int, 2>{set.texels->width(), set.texels->height()});
    for (int row = 0; row < set.texels->tile_rows(); ++row)
      for (int column = 0; column < set.texels->tile_columns(); ++column) add(*set.texels->tile(column, row)->texels());
  }
  return content_hash(view(hashes));
}

double reach_of(const BakedObject& object) {
  return cache().get<Reach>(arrays_of(object), {}, [&] { return Reach{found_reach(object)}; })->distance;
}

}  // namespace

std::uint64_t surface_hash(const BakedObject& object) {
  return cache().get<SurfaceHash>(arrays_of(object), {}, [&] { return SurfaceHash{found_hash(object)}; })->hash;
}

SceneRays rays_among(const std::vector<Occluder>& occluders) {
  std::vector<SceneRays::Instance> instances;
  for (const Occluder& occluder : occluders)
    instances.push_back({rays_of(*occluder.object), occluder.to_frame, occluder.object->bounds().diagonal().norm(),
                         reach_of(*occluder.object) * std::cbrt(std::abs(occluder.to_frame.linear().determinant()))});
  return SceneRays(std::move(instances));
}

}  // namespace rebake
