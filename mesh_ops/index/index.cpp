#include "mesh_ops/index/index.h"

#include <tbb/parallel_for.h>

#include <utility>

#include "mesh_ops/base/hash.h"

namespace rebake {

// Hash of the UVs of all face corners; moving or splitting vertices does not change it.
struct CornerUvs {
  std::uint64_t hash;
};

namespace {

template <class T>
std::uint64_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

ArrayCache& cache() {
  static ArrayCache cache(std::uint64_t{1} << 30);
  return cache;
}

// Arrays that the indices depend on.
ArrayCache::Arrays geometry_of(const BakedObject& object) {
  ArrayCache::Arrays arrays;
  for (const TextureSet& set : object.sets) {
    arrays.push_back(set.soup.shared_positions());
    arrays.push_back(set.soup.shared_faces());
  }
  return arrays;
}
ArrayCache::Arrays surface_of(const BakedObject& object) {
  ArrayCache::Arrays arrays = geometry_of(object);
  for (const TextureSet& set : object.sets) {
    arrays.push_back(set.soup.shared_uvs());
    arrays.push_back(set.texels);
  }
  return arrays;
}

ArrayCache::Arrays places_of(const TextureSet& set) { return {set.soup.shared_positions(), set.soup.shared_faces()}; }
// A RayTree refers to the object's arrays without owning them; the returned pointer owns both.
std::shared_ptr<const RayTree> with_arrays(std::shared_ptr<const RayTree> tree, ArrayCache::Arrays arrays) {
  if (!tree) return nullptr;
  const RayTree* const plain = tree.get();
  return {std::make_shared<std::pair<std::shared_ptr<const RayTree>, ArrayCache::Arrays>>(std::move(tree),
                                                                                          std::move(arrays)),
          plain};
}

}  // namespace

std::uint64_t memory_of(const std::vector<TriangleTraits>& traits) { return bytes_of(traits); }
std::uint64_t memory_of(const std::vector<TexelTraits>& looks) { return bytes_of(looks); }
std::uint64_t memory_of(const SetComponents& parts) { return bytes_of(parts.part_of); }
std::uint64_t memory_of(const EdgeOpacity& opacity) { return bytes_of(opacity.along); }
std::uint64_t memory_of(const WeldedCorners& corners) { return bytes_of(corners.places); }
std::uint64_t memory_of(const WeldedSet& set) { return memory_of(set.corners) + bytes_of(set.points); }
std::uint64_t memory_of(const EdgeTable& edges) { return bytes_of(edges.half_edges) + bytes_of(edges.first_of); }
std::uint64_t memory_of(const Components& parts) { return bytes_of(parts.part_of) + bytes_of(parts.triangles_in); }
std::uint64_t memory_of(const DirectionInfluence& use) {
  return sizeof(DirectionInfluence) +
         sizeof(double) * static_cast<std::uint64_t>(use.without->weights0.size() + use.without->weights1.size());
}
std::uint64_t memory_of(const std::optional<FeatureRange>&) { return sizeof(FeatureRange); }
std::uint64_t memory_of(const CornerUvs&) { return sizeof(CornerUvs); }
std::uint64_t memory_of(const RayTriangles& triangles) { return triangles.memory(); }
std::uint64_t memory_of(const RayTree& tree) { return tree.memory(); }

const ArrayCache& index_cache() { return cache(); }

// Cache settings of per-triangle texel data: a hash of the faces' corner UVs, independent of vertex positions and
// numbering.
static ArrayCache::Settings shown_texels(const TextureSet& set) {
  const auto corners = cache().get<CornerUvs>({set.soup.shared_uvs(), set.soup.shared_faces()}, {}, [&] {
    std::vector<Vec2> uvs;
    uvs.reserve(3 * set.soup.triangle_count());
    for (const Face& face : set.soup.faces())
      for (const std::uint32_t vertex : face) uvs.push_back(set.soup.uvs()[vertex]);
    return CornerUvs{content_hash({reinterpret_cast<const char*>(uvs.data()), uvs.size() * sizeof(Vec2)})};
  });
  // A double represents 32 bits exactly.
  return {static_cast<double>(corners->hash >> 32), static_cast<double>(corners->hash & 0xffffffffU)};
}

static std::shared_ptr<const WeldedSet> welded_set(const TextureSet& set) {
  return cache().get<WeldedSet>(places_of(set), {}, [&] { return weld_set(set.soup); });
}

std::shared_ptr<const DirectionInfluence> direction_influence_of(const std::shared_ptr<const Decoder>& decoder) {
  return cache().get<DirectionInfluence>({decoder}, {}, [&] { return direction_influence(*decoder); });
}
std::shared_ptr<const std::optional<FeatureRange>> feature_range_of(
    const std::shared_ptr<const FeatureTexture>& texture) {
  return cache().get<std::optional<FeatureRange>>({texture}, {}, [&] { return narrow_feature_range(*texture); });
}

std::shared_ptr<const std::vector<TriangleTraits>> traits_of(const BakedObject& object) {
  ArrayCache::Arrays arrays = surface_of(object);
  arrays.push_back(object.decoder);
  return cache().get<std::vector<TriangleTraits>>(arrays, {}, [&] {
    std::vector<std::shared_ptr<const std::vector<TexelTraits>>> looks;
    for (const TextureSet& set : object.sets) {
      looks.push_back(cache().get<std::vector<TexelTraits>>({set.texels, object.decoder}, shown_texels(set),
                                                            [&] { return texel_traits(set, *object.decoder); }));
    }
    return triangle_traits(object, looks);
  });
}
std::shared_ptr<const WeldedCorners> corners_of(const BakedObject& object, double tolerance) {
  return cache().get<WeldedCorners>(geometry_of(object), {tolerance}, [&] {
    std::vector<std::shared_ptr<const WeldedSet>> sets;
    for (const TextureSet& set : object.sets) sets.push_back(welded_set(set));
    return weld(object, sets, tolerance);
  });
}
std::shared_ptr<const EdgeTable> edges_of(const BakedObject& object, double tolerance) {
  return cache().get<EdgeTable>(geometry_of(object), {tolerance},
                                [&] { return edges_between(*corners_of(object, tolerance)); });
}
std::shared_ptr<const Components> components_of(const BakedObject& object, const Connectivity& joining) {
  return cache().get<Components>(surface_of(object), {joining.tolerance, joining.gap}, [&] {
    std::vector<std::shared_ptr<const EdgeOpacity>> opacity;
    for (const TextureSet& set : object.sets)
      opacity.push_back(cache().get<EdgeOpacity>({set.texels}, shown_texels(set), [&] { return edge_opacity(set); }));
    if (joining.tolerance > 0 || joining.gap > 0)
      return opaque_components(object, *corners_of(object, joining.tolerance), *edges_of(object, joining.tolerance),
                               opacity, joining.gap);
    std::vector<IndexedSet> sets(object.sets.size());
    tbb::parallel_for(std::size_t{0}, sets.size(), [&](std::size_t s) {
      const TextureSet& set = object.sets[s];
      const ArrayCache::Arrays places = places_of(set);
      ArrayCache::Arrays all = places;
      all.push_back(set.soup.shared_uvs());
      all.push_back(set.texels);
      sets[s] = {opacity[s], cache().get<SetComponents>(all, {}, [&] {
                   const auto welded = welded_set(set);
                   const auto edges =
                       cache().get<EdgeTable>(places, {}, [&] { return edges_between(welded->corners); });
                   return set_components(welded->corners, *edges, *opacity[s]);
                 })};
    });
    return joined_components(*corners_of(object), sets);
  });
}
// Marks the triangles as used after their tree, so that the cache evicts the tree, which owns them too, first.
static void touch_triangles(const BakedObject& object) { cache().try_get<RayTriangles>(geometry_of(object), {}); }

std::shared_ptr<const RayTree> rays_of(const BakedObject& object) {
  ArrayCache::Arrays arrays = surface_of(object);
  auto tree = cache().get<RayTree>(arrays, {}, [&] {
    return RayTree(cache().get<RayTriangles>(geometry_of(object), {}, [&] { return RayTriangles(object); }), object);
  });
  touch_triangles(object);
  return with_arrays(std::move(tree), std::move(arrays));
}
std::shared_ptr<const RayTree> try_rays_of(const BakedObject& object) {
  const auto triangles = cache().try_get<RayTriangles>(geometry_of(object), {});
  if (!triangles) return nullptr;
  ArrayCache::Arrays arrays = surface_of(object);
  auto tree = cache().get<RayTree>(arrays, {}, [&] { return RayTree(triangles, object); });
  touch_triangles(object);
  return with_arrays(std::move(tree), std::move(arrays));
}

SceneRays rays_through(const std::vector<PlacedNode>& objects) {
  std::vector<SceneRays::Instance> instances;
  for (const PlacedNode& placed : objects)
    instances.push_back(
        {rays_of(*placed.node->object), placed.to_world, placed.node->object->bounds().diagonal().norm()});
  return SceneRays(std::move(instances));
}

void prepare_index(const BakedObject& object, const Progress& progress) {
  progress.at("indexing", 0);
  traits_of(object);
  progress.at("indexing", 0.35);
  components_of(object);
  progress.at("indexing", 0.7);
  rays_of(object);
  progress.at("indexing", 1);
}

}  // namespace rebake
