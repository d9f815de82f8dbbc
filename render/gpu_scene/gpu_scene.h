#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "mesh_ops/light/lighting.h"
#include "render/gl/objects.h"
#include "render/gl/to_glm.h"
#include "render/gpu_scene/clusters.h"
#include "render/gpu_scene/resources.h"
#include "render/gpu_scene/surface.h"

namespace rebake {

/// Faces [first_face, first_face + face_count) with their bounding box in object space, for frustum culling.
struct GpuCluster {
  std::size_t first_face = 0;
  std::size_t face_count = 0;
  Box bounds;
};

/// Positions of a texture set, prepared on the CPU for upload: floats relative to `center`.
struct PreparedMesh {
  TextureSet source;  ///< keeps the arrays alive whose addresses are in the MeshKey
  /// Faces that the clusters contain. A surface that was taken over from another texture may have more faces.
  std::shared_ptr<const std::vector<Face>> shown;
  Vec3 center{0, 0, 0};
  std::vector<glm::vec3> positions;
  std::vector<glm::mat3> turns;  ///< rotation per vertex; empty if no vertex is rotated
  std::vector<GpuCluster> clusters;
  FaceClusters nearby;  ///< clusters for occlusion culling
};
/// Prepares the positions of a set. `shown`: faces of its surface.
PreparedMesh prepared(const TextureSet& set, const ShownFaces& shown);

/// Positions of a texture set on the GPU, and clusters of its triangles. Texels and indices are in its GpuSurface.
struct GpuMesh {
  TextureSet source;
  Vec3 center{0, 0, 0};
  gl::VertexArray array;
  gl::Buffer positions;
  gl::Buffer turns;
  std::vector<GpuCluster> clusters;
  FaceClusters nearby;
};

/// Sets the attributes of the bound vertex array: positions and a surface's vertices.
void bind_vertices(const gl::Buffer& positions, const GpuSurface& surface);

/// A light map on the GPU.
struct GpuLight {
  std::shared_ptr<const LightMap> source;
  gl::Buffer places;                                  ///< per vertex: position in the map, in nodes
  gl::Texture gain, offset;                           ///< `offset` is empty if the map has none
  gl::Texture gloss_before, gloss_after, gloss_suns;  ///< empty if the map has no gloss
};

/// Owner of the resident GPU data: those of the current scene, and those of a scene that is being uploaded in slices.
class GpuScene {
 public:
  /// Uploads the missing data of `scene` and evicts data that it does not need. `coded`: store texels in lossless
  /// blocks, which take about half the memory.
  void update(const Scene& scene, bool coded, const Lighting* lighting = nullptr);
  /// Uploads a slice of the data that update() would upload for `scene`, beside the current data: for about
  /// `milliseconds`, and at least one piece. Returns the uploaded share, 0 … 1. Small changes are left to update(),
  /// which takes over the uploaded data.
  double upload_slice(const Scene& scene, bool coded, double milliseconds);
  /// Evicts the data uploaded by upload_slice() for a scene that was not drawn.
  void evict_staged();
  /// Records the resident meshes and surfaces for prepare(), and frees its prepared copies of them.
  void record_held();
  /// Prepares data on the CPU that update() will upload. Callable from any thread; update() prepares the rest.
  void prepare(const Scene& scene, bool coded);

  MeshKey key(const TextureSet& set) const { return mesh_key(set, coded_); }
  const GpuMesh& mesh(const TextureSet& set) const { return meshes_.at(key(set)); }
  const GpuSurface& surface(const TextureSet& set) const { return surfaces_.at(surface_key(set, coded_)); }
  /// Number of texels uploaded so far.
  std::uint64_t texels_uploaded() const { return texels_uploaded_; }
  /// Memory of the resident texels in bytes.
  std::uint64_t texel_bytes() const;
  const GpuLight& light(const std::shared_ptr<const LightMap>& map) const { return lights_.at(map.get()); }

 private:
  void update_light(const Lighting* lighting);
  /// Removes and returns the prepared data of a set; prepares them if there are none.
  PreparedMesh take_mesh(const TextureSet& set, bool coded, const GpuSurface& surface);
  PreparedSurface take_surface(const TextureSet& set, bool coded);
  ResourceDiff difference(const Scene& scene, bool coded) const;
  void plan_staged_upload(const Scene& scene, bool coded);

  std::map<MeshKey, GpuMesh> meshes_;
  std::map<SurfaceKey, GpuSurface> surfaces_;
  std::map<const LightMap*, GpuLight> lights_;
  bool coded_ = false;         ///< whether the current scene's texels are coded
  std::uint64_t changes_ = 0;  ///< number of changes of meshes_ and surfaces_
  /// Upload in slices of a scene that is not drawn yet.
  struct StagedUpload {
    std::vector<NodePtr> roots;  ///< identify the scene
    bool coded = false;
    std::uint64_t changes = 0;                               ///< value of changes_ when this was planned
    std::vector<TextureSet> surfaces, meshes;                ///< sets to upload
    std::size_t surfaces_uploaded = 0, meshes_uploaded = 0;  ///< number of uploaded ones
  };
  std::optional<StagedUpload> staged_upload_;
  std::map<SurfaceKey, GpuSurface> staged_surfaces_;
  std::map<MeshKey, GpuMesh> staged_meshes_;
  std::uint64_t texels_uploaded_ = 0;
  // Guarded by mutex_, because prepare() uses them from other threads:
  std::mutex mutex_;
  /// A resident surface; `source` keeps the arrays alive whose addresses are in the key.
  struct Held {
    TextureSet source;
    std::shared_ptr<const FeatureTexture> opacity_source;
    ShownFaces shown;
  };
  std::map<MeshKey, TextureSet> held_meshes_;
  std::map<SurfaceKey, ShownFaces> staged_shown_;
  std::map<SurfaceKey, Held> held_surfaces_;
  /// Prepared data that wait for update().
  template <class Prepared>
  struct PreparedEntry {
    Prepared made;
    unsigned turn = 0;  ///< number of the last call of prepare() that needed it
  };
  std::map<MeshKey, PreparedEntry<PreparedMesh>> prepared_meshes_;
  std::map<SurfaceKey, PreparedEntry<PreparedSurface>> prepared_surfaces_;
  unsigned prepare_calls_ = 0;  ///< number of calls of prepare()
};

}  // namespace rebake
