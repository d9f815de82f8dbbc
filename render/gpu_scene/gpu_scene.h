#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "mesh_ops/light/lighting.h"
#include "render/gl/objects.h"
#include "render/gpu_scene/clusters.h"
#include "render/gpu_scene/resources.h"
#include "render/gpu_scene/surface.h"

namespace rebake {

/// Faces [first, first + count) and their box, so that what is out of view is not drawn.
struct GpuCluster {
  std::size_t first_face = 0;
  std::size_t face_count = 0;
  Box bounds;
};

/// What is uploaded of where a set's vertices are, worked out beforehand: floats relative to `center`.
struct PreparedMesh {
  TextureSet source;  ///< keeps the arrays alive, so that their addresses stay identities
  /// What its clusters are of. One surface may show more faces than another of the same texels.
  std::shared_ptr<const std::vector<Face>> shown;
  Vec3 center{0, 0, 0};
  std::vector<Eigen::Vector3f> positions;
  std::vector<float> turns;  ///< 9 a vertex; empty where none is turned
  std::vector<GpuCluster> clusters;
  FaceClusters nearby;
};
PreparedMesh prepared(const TextureSet& set, const ShownFaces& shown);

/// A texture set's triangles on the GPU.
struct GpuMesh {
  TextureSet source;
  Vec3 center{0, 0, 0};
  gl::VertexArray array;
  gl::Buffer positions;
  gl::Buffer turns;
  std::vector<GpuCluster> clusters;
  FaceClusters nearby;
};

/// Makes the vertex array that is bound read positions and a surface's vertices.
void bind_vertices(const gl::Buffer& positions, const GpuSurface& surface);

/// A light map on the GPU.
struct GpuLight {
  std::shared_ptr<const LightMap> source;
  gl::Buffer places;
  gl::Texture gain, offset;                           ///< no offset where there is none
  gl::Texture gloss_before, gloss_after, gloss_suns;  ///< where there is any
};

/// Owns what is on the GPU for the current scene.
class GpuScene {
 public:
  /// Uploads what is missing and releases what `scene` no longer holds. `coded`: texels in blocks, in about half the
  /// memory, to the same picture.
  void update(const Scene& scene, bool coded, const Lighting* lighting = nullptr);
  /// Uploads some of what update() would of `scene`, for about so long and at least a piece, beside what is there;
  /// returns how much of it is, from 0 to 1. What is little is left to update(), which takes what has arrived.
  double arrive(const Scene& scene, bool coded, double milliseconds);
  /// Lets go of what arrived for a scene that was not drawn.
  void forget_arrival();
  /// Works out what update() will upload, from any thread; it takes what there is of it.
  void prepare(const Scene& scene, bool coded);

  MeshKey key(const TextureSet& set) const { return mesh_key(set, coded_); }
  const GpuMesh& mesh(const TextureSet& set) const { return meshes_.at(key(set)); }
  const GpuSurface& surface(const TextureSet& set) const { return surfaces_.at(surface_key(set, coded_)); }
  /// So far.
  std::uint64_t texels_uploaded() const { return texels_uploaded_; }
  std::uint64_t texel_bytes() const;  ///< held
  const GpuLight& light(const std::shared_ptr<const LightMap>& map) const { return lights_.at(map.get()); }

 private:
  void update_light(const Lighting* lighting);
  /// What was prepared of a set, or is now.
  PreparedMesh take_mesh(const TextureSet& set, bool coded, const GpuSurface& surface);
  PreparedSurface take_surface(const TextureSet& set, bool coded);
  ResourceDiff difference(const Scene& scene, bool coded) const;
  void plan_arrival(const Scene& scene, bool coded);

  std::map<MeshKey, GpuMesh> meshes_;
  std::map<SurfaceKey, GpuSurface> surfaces_;
  std::map<const LightMap*, GpuLight> lights_;
  bool coded_ = false;         ///< the texels of the scene that is there
  std::uint64_t changes_ = 0;  ///< of the maps above
  // What arrives for a scene that is not drawn yet, and what is still missing then.
  struct Arrival {
    std::vector<NodePtr> roots;  ///< of the scene
    bool coded = false;
    std::uint64_t changes = 0;  ///< when this was planned
    std::vector<TextureSet> surfaces, meshes;
    std::size_t surfaces_there = 0, meshes_there = 0;
  };
  std::optional<Arrival> arrival_;
  std::map<SurfaceKey, GpuSurface> arriving_surfaces_;
  std::map<MeshKey, GpuMesh> arriving_meshes_;
  std::uint64_t texels_uploaded_ = 0;
  // Shared with prepare():
  std::mutex mutex_;
  /// Of what is on the GPU; sources keep what the keys are made of alive.
  struct Held {
    TextureSet source;
    std::shared_ptr<const FeatureTexture> made_for;
    ShownFaces shown;
  };
  std::map<MeshKey, TextureSet> held_meshes_;
  std::map<SurfaceKey, ShownFaces> arriving_shown_;
  std::map<SurfaceKey, Held> held_surfaces_;
  template <class Prepared>
  struct Waiting {
    Prepared made;
    unsigned turn = 0;  ///< the call of prepare() that wanted it last
  };
  std::map<MeshKey, Waiting<PreparedMesh>> prepared_meshes_;
  std::map<SurfaceKey, Waiting<PreparedSurface>> prepared_surfaces_;
  unsigned turn_ = 0;
};

}  // namespace rebake
