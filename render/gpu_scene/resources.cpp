#include "render/gpu_scene/resources.h"

namespace rebake {

SurfaceKey surface_key(const TextureSet& set, bool coded) {
  return {set.soup.shared_uvs().get(), set.soup.shared_faces().get(), set.texels.get(), coded};
}

MeshKey mesh_key(const TextureSet& set, bool coded) {
  return {set.soup.shared_positions().get(), set.soup.vertex_attributes().shared(Soup::rotation).get(),
          surface_key(set, coded)};
}

ResourceDiff diff(const std::set<MeshKey>& held_meshes, const std::set<SurfaceKey>& held_surfaces, const Scene& scene,
                  bool coded) {
  ResourceDiff result;
  std::set<MeshKey> wanted_meshes;
  std::set<SurfaceKey> wanted_surfaces;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object) continue;
    for (const TextureSet& set : placed.node->object->sets) {
      const MeshKey key = mesh_key(set, coded);
      if (wanted_meshes.insert(key).second && !held_meshes.contains(key)) result.meshes.push_back(set);
      if (wanted_surfaces.insert(key.surface).second && !held_surfaces.contains(key.surface))
        result.surfaces.push_back(set);
    }
  }
  for (const MeshKey& key : held_meshes)
    if (!wanted_meshes.contains(key)) result.released_meshes.push_back(key);
  for (const SurfaceKey& key : held_surfaces)
    if (!wanted_surfaces.contains(key)) result.released_surfaces.push_back(key);
  return result;
}

}  // namespace rebake
