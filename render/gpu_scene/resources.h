#pragma once

#include <compare>
#include <memory>
#include <set>
#include <vector>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Identity of a mesh on the GPU: the shared arrays that it was made from.
struct MeshKey {
  const void* positions = nullptr;
  const void* uvs = nullptr;
  const void* faces = nullptr;
  const void* turns = nullptr;
  const void* texels = nullptr;  ///< UVs are scaled by its size, and faces that show no opaque texel are left out
  auto operator<=>(const MeshKey&) const = default;
};
MeshKey mesh_key(const TextureSet& set);

/// Identity of a feature texture on the GPU.
using TextureKey = const FeatureTexture*;

/// What to upload before a picture can be drawn, and what nothing needs any more.
struct ResourceDiff {
  std::vector<TextureSet> meshes;
  std::vector<std::shared_ptr<const FeatureTexture>> textures;
  std::vector<MeshKey> released_meshes;
  std::vector<TextureKey> released_textures;
};

/// Pure: compares what is held with what a scene can draw (hidden nodes included, so that showing them again is
/// instant).
ResourceDiff diff(const std::set<MeshKey>& held_meshes, const std::set<TextureKey>& held_textures, const Scene& scene);

}  // namespace rebake
