#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "mesh_ops/light/lighting.h"
#include "render/gl/objects.h"
#include "render/gpu_scene/clusters.h"
#include "render/gpu_scene/resources.h"

namespace rebake {

/// What geometry.vert reads of a vertex.
struct GpuVertex {
  float position[3];
  float texel[2];
};

/// Faces [first, first + count) and their box, so that what is out of view is not drawn.
struct GpuCluster {
  std::size_t first_face = 0;
  std::size_t face_count = 0;
  Box bounds;
};

/// A set's faces that may show something, shared by all that differ in places only, and an order of them in which
/// neighbours stay neighbours wherever edits move them.
struct ShownFaces {
  std::shared_ptr<const std::vector<Face>> faces;
  NearbyOrder nearby;
};

/// What is uploaded of a texture set, worked out beforehand: positions as floats relative to `center`, UVs in texels.
struct PreparedMesh {
  TextureSet source;  ///< keeps arrays and texels alive, so that their addresses stay identities
  Vec3 center{0, 0, 0};
  std::vector<GpuVertex> vertices;
  std::vector<float> turns;  ///< 9 a vertex; empty where none is turned
  ShownFaces shown;
  std::vector<GpuCluster> clusters;
  FaceClusters nearby;
};
/// `shown` is empty where it is not known yet.
PreparedMesh prepared(const TextureSet& set, ShownFaces shown = {});

/// A texture set's triangles on the GPU.
struct GpuMesh {
  TextureSet source;
  Vec3 center{0, 0, 0};
  gl::VertexArray array;
  gl::Buffer vertices;
  gl::Buffer turns;
  gl::Buffer indices;
  ShownFaces shown;  ///< faces as in `indices`
  std::vector<GpuCluster> clusters;
  FaceClusters nearby;
};

struct GpuTexture {
  std::shared_ptr<const FeatureTexture> source;
  gl::Texture texture;
};

/// A light map on the GPU.
struct GpuLight {
  std::shared_ptr<const LightMap> source;
  gl::Buffer places;
  gl::Texture gain, offset;  ///< no offset where there is none
};

/// Owns what is on the GPU for the current scene.
class GpuScene {
 public:
  /// Uploads what is missing and releases what `scene` no longer holds.
  void update(const Scene& scene, const Lighting* lighting = nullptr);
  /// Works out what update() will upload, from any thread; it takes what there is of it.
  void prepare(const Scene& scene);

  const GpuMesh& mesh(const TextureSet& set) const { return meshes_.at(mesh_key(set)); }
  const GpuTexture& texture(const TextureSet& set) const { return textures_.at(set.texels.get()); }
  const GpuLight& light(const std::shared_ptr<const LightMap>& map) const { return lights_.at(map.get()); }

 private:
  void update_light(const Lighting* lighting);
  PreparedMesh take_prepared(const TextureSet& set);

  std::map<MeshKey, GpuMesh> meshes_;
  std::map<TextureKey, GpuTexture> textures_;
  std::map<const LightMap*, GpuLight> lights_;
  // Shared with prepare():
  std::mutex mutex_;
  struct Held {
    TextureSet source;  ///< keeps what the key is made of alive
    ShownFaces shown;
  };
  std::map<MeshKey, Held> held_;  ///< of what is on the GPU
  struct Waiting {
    PreparedMesh mesh;
    unsigned turn = 0;  ///< the call of prepare() that wanted it last
  };
  std::map<MeshKey, Waiting> prepared_;
  unsigned turn_ = 0;
};

}  // namespace rebake
