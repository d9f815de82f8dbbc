#pragma once

#include <compare>
#include <memory>
#include <set>
#include <vector>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Identity of what a set shows wherever its vertices are: texels on the GPU, and where triangles find them.
struct SurfaceKey {
  const void* uvs = nullptr;
  const void* faces = nullptr;
  const void* texels = nullptr;
  bool coded = false;  ///< whether its texels are
  auto operator<=>(const SurfaceKey&) const = default;
};
SurfaceKey surface_key(const TextureSet& set, bool coded);

/// Identity of a mesh on the GPU: the shared arrays that it was made from.
struct MeshKey {
  const void* positions = nullptr;
  const void* turns = nullptr;
  SurfaceKey surface;
  auto operator<=>(const MeshKey&) const = default;
};
MeshKey mesh_key(const TextureSet& set, bool coded);

/// What to upload before a picture can be drawn, and what nothing needs any more.
struct ResourceDiff {
  std::vector<TextureSet> meshes;
  std::vector<TextureSet> surfaces;
  std::vector<MeshKey> released_meshes;
  std::vector<SurfaceKey> released_surfaces;
};

/// Pure: compares what is held with what a scene can draw (hidden nodes included, so that showing them again is
/// instant).
ResourceDiff diff(const std::set<MeshKey>& held_meshes, const std::set<SurfaceKey>& held_surfaces, const Scene& scene,
                  bool coded);

}  // namespace rebake
