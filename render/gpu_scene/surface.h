#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "render/gl/objects.h"
#include "render/gpu_scene/clusters.h"
#include "render/gpu_scene/coded_texels.h"
#include "render/gpu_scene/packed_texels.h"

namespace rebake {

/// What geometry.vert reads of a vertex besides its position.
struct SurfaceVertex {
  float texel[2];                               ///< in texels of the texture, v down
  std::uint16_t first_texel[2], last_texel[2];  ///< of its rectangle
  /// Of the rectangle's first texel among those on the GPU; of coded ones the halves of its first block's number.
  std::uint16_t place[2];
};

/// A set's faces that may show something, and an order of them in which neighbours stay neighbours wherever edits move
/// them.
struct ShownFaces {
  std::shared_ptr<const std::vector<Face>> faces;
  NearbyOrder nearby;
};

/// What is uploaded of a set wherever its vertices are, worked out beforehand.
struct PreparedSurface {
  TextureSet source;  ///< keeps arrays and texels alive, so that their addresses stay identities
  ShownFaces shown;
  std::shared_ptr<const TexelPacking> packing;
  std::optional<CodedTexels> coded;  ///< its texels, where they are to be and can
  std::vector<SurfaceVertex> vertices;
};
PreparedSurface prepared_surface(const TextureSet& set, bool coded);

/// Texels of a surface as blocks.
struct GpuCodedTexels {
  std::vector<std::uint32_t> first_block, first_word;  ///< as in CodedTexels
  gl::Buffer blocks, words;
  gl::Texture read_blocks, read_words;
  CodedTexels waiting;       ///< what is still to be uploaded
  std::size_t uploaded = 0;  ///< bytes of it, blocks first
};

/// A set's faces and texels on the GPU.
struct GpuSurface {
  TextureSet source;
  std::shared_ptr<const FeatureTexture> made_for;  ///< whose opaque texels decided what is here
  ShownFaces shown;                                ///< faces as in `indices`
  std::shared_ptr<const TexelPacking> packing;
  gl::Buffer vertices;
  gl::Buffer indices;
  gl::Texture texels;
  std::optional<GpuCodedTexels> coded;         ///< instead of those
  double uploaded = 0;                         ///< the share of its texels
  int rows_uploaded = 0;                       ///< of the texels
  std::unique_ptr<const TexelReader> reading;  ///< of the source's, while they are uploaded
};
/// All but the texels.
GpuSurface begin_upload(PreparedSurface made);
/// Some more of its texels, at most a few milliseconds' worth. Returns whether those were the last.
bool upload_more(GpuSurface& surface);

/// Whether a surface is good for a set with the same triangles: no texel has become opaque, and sizes are the same.
bool serves(const std::shared_ptr<const FeatureTexture>& made_for, const TextureSet& source, const TextureSet& set);
/// Makes it that set's, for which it serves: uploads what changed of the texels, and returns how many it uploaded.
std::uint64_t take_over(GpuSurface& surface, const TextureSet& set);

}  // namespace rebake
