#include "mesh_ops/index/index.h"

#include <utility>

namespace rebake {

namespace {

template <class T>
std::uint64_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

ArrayCache& cache() {
  static ArrayCache cache(std::uint64_t{1} << 30);
  return cache;
}

// What each depends on.
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

// Trees look texels up in the object's arrays without keeping them; who uses one keeps both.
std::shared_ptr<const RayTree> with_arrays(std::shared_ptr<const RayTree> tree, ArrayCache::Arrays arrays) {
  if (!tree) return nullptr;
  const RayTree* const plain = tree.get();
  return {std::make_shared<std::pair<std::shared_ptr<const RayTree>, ArrayCache::Arrays>>(std::move(tree),
                                                                                          std::move(arrays)),
          plain};
}

}  // namespace

std::uint64_t memory_of(const std::vector<TriangleTraits>& traits) { return bytes_of(traits); }
std::uint64_t memory_of(const WeldedCorners& corners) { return bytes_of(corners.places); }
std::uint64_t memory_of(const EdgeTable& edges) { return bytes_of(edges.half_edges) + bytes_of(edges.first_of); }
std::uint64_t memory_of(const Components& parts) { return bytes_of(parts.part_of) + bytes_of(parts.triangles_in); }
std::uint64_t memory_of(const RayTree& tree) { return tree.memory(); }

const ArrayCache& index_cache() { return cache(); }

std::shared_ptr<const std::vector<TriangleTraits>> traits_of(const BakedObject& object) {
  ArrayCache::Arrays arrays = surface_of(object);
  arrays.push_back(object.decoder);
  return cache().get<std::vector<TriangleTraits>>(arrays, {}, [&] { return triangle_traits(object); });
}
std::shared_ptr<const WeldedCorners> corners_of(const BakedObject& object, double tolerance) {
  return cache().get<WeldedCorners>(geometry_of(object), {tolerance}, [&] { return weld(object, tolerance); });
}
std::shared_ptr<const EdgeTable> edges_of(const BakedObject& object, double tolerance) {
  return cache().get<EdgeTable>(geometry_of(object), {tolerance},
                                [&] { return edges_between(*corners_of(object, tolerance)); });
}
std::shared_ptr<const Components> components_of(const BakedObject& object, const Joining& joining) {
  return cache().get<Components>(surface_of(object), {joining.tolerance, joining.gap}, [&] {
    return opaque_components(object, *corners_of(object, joining.tolerance), *edges_of(object, joining.tolerance),
                             joining.gap);
  });
}
std::shared_ptr<const RayTree> rays_of(const BakedObject& object) {
  ArrayCache::Arrays arrays = surface_of(object);
  return with_arrays(cache().get<RayTree>(arrays, {}, [&] { return RayTree(object); }), arrays);
}
std::shared_ptr<const RayTree> rays_if_there(const BakedObject& object) {
  ArrayCache::Arrays arrays = surface_of(object);
  return with_arrays(cache().if_there<RayTree>(arrays, {}), arrays);
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
