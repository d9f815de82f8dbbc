#pragma once

#include <compare>
#include <memory>
#include <set>
#include <vector>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Identity of a GpuSurface: addresses of the shared arrays of its texture set. Independent of positions.
struct SurfaceKey {
  const void* uvs = nullptr;
  const void* faces = nullptr;
  const void* texels = nullptr;
  bool coded = false;  ///< whether its texels are losslessly compressed (CodedTexels)
  auto operator<=>(const SurfaceKey&) const = default;
};
SurfaceKey surface_key(const TextureSet& set, bool coded);

/// Identity of a GpuMesh: addresses of the shared arrays of its texture set, and its surface.
struct MeshKey {
  const void* positions = nullptr;
  const void* turns = nullptr;  ///< rotations per vertex; null if there are none
  SurfaceKey surface;
  auto operator<=>(const MeshKey&) const = default;
};
MeshKey mesh_key(const TextureSet& set, bool coded);

/// Sets to upload before a scene can be drawn, and keys of resident data to evict.
struct ResourceDiff {
  std::vector<TextureSet> meshes;
  std::vector<TextureSet> surfaces;
  std::vector<MeshKey> released_meshes;
  std::vector<SurfaceKey> released_surfaces;
};

/// Compares resident data with the needs of a scene. Hidden nodes count too, so that showing them again uploads
/// nothing. Pure.
ResourceDiff diff(const std::set<MeshKey>& held_meshes, const std::set<SurfaceKey>& held_surfaces, const Scene& scene,
                  bool coded);

}  // namespace rebake
