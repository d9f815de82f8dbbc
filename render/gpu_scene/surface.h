#pragma once

#include <glm/ext/vector_uint2_sized.hpp>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "render/gl/objects.h"
#include "render/gpu_scene/clusters.h"
#include "render/gpu_scene/coded_texels.h"
#include "render/gpu_scene/packed_texels.h"

namespace rebake {

/// Vertex attributes of geometry.vert except the position.
struct SurfaceVertex {
  glm::vec2 texel;                       ///< texture coordinates in texels, v down
  glm::u16vec2 first_texel, last_texel;  ///< corners of its rectangle in the texture, inclusive
  /// Corner of the rectangle in the packed texture; if texels are coded, low and high half of its first block's index.
  glm::u16vec2 place;
};

/// Faces of a set that may show opaque texels, and a spatial order of them, which is reused when edits move vertices.
struct ShownFaces {
  std::shared_ptr<const std::vector<Face>> faces;
  SpatialOrder nearby;
};

/// Data of a texture set that do not depend on positions (faces, texels), prepared on the CPU for upload.
struct PreparedSurface {
  TextureSet source;  ///< keeps the arrays alive whose addresses are in the SurfaceKey
  ShownFaces shown;
  std::shared_ptr<const TexelPacking> packing;
  std::optional<CodedTexels> coded;  ///< coded texels, if wanted and worthwhile
  std::vector<SurfaceVertex> vertices;
};
/// Prepares a set. `coded`: code its texels if that saves memory.
PreparedSurface prepared_surface(const TextureSet& set, bool coded);

/// Coded texels of a surface on the GPU.
struct GpuCodedTexels {
  std::vector<std::uint32_t> first_block, first_word;  ///< as in CodedTexels
  gl::Buffer blocks, words;
  gl::Texture read_blocks, read_words;  ///< buffer textures of `blocks` and `words`
  CodedTexels waiting;                  ///< data to upload; empty when all are uploaded
  std::size_t uploaded = 0;             ///< number of uploaded bytes, blocks first
};

/// Faces and texels of a texture set on the GPU. Positions are in a GpuMesh.
struct GpuSurface {
  TextureSet source;
  std::shared_ptr<const FeatureTexture>
      opacity_source;  ///< texture whose opaque texels determined `shown` and `packing`
  ShownFaces shown;    ///< faces in the order of `indices`
  std::shared_ptr<const TexelPacking> packing;
  gl::Buffer vertices;
  gl::Buffer indices;
  gl::Texture texels;
  std::optional<GpuCodedTexels> coded;         ///< if set, used instead of `texels`
  double uploaded = 0;                         ///< share of the texels, 0 … 1
  int rows_uploaded = 0;                       ///< rows of `texels`
  std::unique_ptr<const TexelReader> reading;  ///< unpacks the source's texels during the upload
};
/// Uploads vertices and indices, and allocates the texels.
GpuSurface begin_upload(PreparedSurface made);
/// Uploads the next slice of texels, at most a few milliseconds' worth. Returns whether it was the last.
bool upload_next_slice(GpuSurface& surface);

/// Whether a surface of `source`, with GpuSurface::opacity_source, can be reused for `set`: both share UVs and faces,
/// textures have the same size, and no texel has become opaque.
bool is_reusable_for(const std::shared_ptr<const FeatureTexture>& opacity_source, const TextureSet& source,
                     const TextureSet& set);
/// Reuses a surface for `set`, for which it serves(): uploads the changed texels and returns their number.
std::uint64_t reuse_surface(GpuSurface& surface, const TextureSet& set);

}  // namespace rebake
