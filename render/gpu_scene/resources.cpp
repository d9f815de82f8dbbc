#include "render/gpu_scene/resources.h"

namespace rebake {

MeshKey mesh_key(const TextureSet& set) {
  return {set.soup.shared_positions().get(), set.soup.shared_uvs().get(), set.soup.shared_faces().get(),
          set.soup.vertex_attributes().shared(Soup::rotation).get(), set.texels.get()};
}

ResourceDiff diff(const std::set<MeshKey>& held_meshes, const std::set<TextureKey>& held_textures, const Scene& scene) {
  ResourceDiff result;
  std::set<MeshKey> wanted_meshes;
  std::set<TextureKey> wanted_textures;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object) continue;
    for (const TextureSet& set : placed.node->object->sets) {
      const MeshKey key = mesh_key(set);
      if (wanted_meshes.insert(key).second && !held_meshes.contains(key)) result.meshes.push_back(set);
      if (wanted_textures.insert(set.texels.get()).second && !held_textures.contains(set.texels.get()))
        result.textures.push_back(set.texels);
    }
  }
  for (const MeshKey& key : held_meshes)
    if (!wanted_meshes.contains(key)) result.released_meshes.push_back(key);
  for (const TextureKey key : held_textures)
    if (!wanted_textures.contains(key)) result.released_textures.push_back(key);
  return result;
}

}  // namespace rebake
