#pragma once

#include <map>
#include <memory>
#include <vector>

#include "render/gl/objects.h"
#include "render/gpu_scene/resources.h"

namespace rebake {

/// What geometry.vert reads of a vertex.
struct GpuVertex {
  float position[3];
  float texel[2];
};

/// A texture set's triangles on the GPU: positions as floats relative to `center`, UVs in texels.
struct GpuMesh {
  /// Faces [first, first + count) and their box, so that what is out of view is not drawn.
  struct Cluster {
    std::size_t first_face = 0;
    std::size_t face_count = 0;
    Box bounds;
  };
  Soup source;  ///< keeps the arrays alive, so that their addresses stay identities
  Vec3 center{0, 0, 0};
  gl::VertexArray array;
  gl::Buffer vertices;
  gl::Buffer turns;
  gl::Buffer indices;
  std::vector<Face> faces;  ///< those that may show something, as in `indices`
  std::vector<Cluster> clusters;
};

struct GpuTexture {
  std::shared_ptr<const FeatureTexture> source;
  gl::Texture texture;
};

/// Owns what is on the GPU for the current scene.
class GpuScene {
 public:
  /// Uploads what is missing and releases what `scene` no longer holds.
  void update(const Scene& scene);

  const GpuMesh& mesh(const TextureSet& set) const { return meshes_.at(mesh_key(set)); }
  const GpuTexture& texture(const TextureSet& set) const { return textures_.at(set.texels.get()); }

 private:
  std::map<MeshKey, GpuMesh> meshes_;
  std::map<TextureKey, GpuTexture> textures_;
};

}  // namespace rebake
