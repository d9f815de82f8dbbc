#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// A rectangle of a texture's texels, and where it lies among those on the GPU.
struct PackedRect {
  std::uint16_t x = 0, y = 0;  ///< row 0 at the top
  std::uint16_t width = 1, height = 1;
  std::uint16_t place_x = 0, place_y = 0;
  bool operator==(const PackedRect&) const = default;
};

/// Which texels of a set are on the GPU. Triangles that share vertices share the rectangle that holds all their texels;
/// rectangles of triangles that show nothing are not there.
struct TexelPacking {
  int width = 1, height = 1;      ///< of what is on the GPU
  bool whole = false;             ///< texels lie where they do in the texture: packing would save too little
  std::vector<PackedRect> rects;  ///< in the order of the texture's tiles that they begin in
  /// For each vertex its rectangle; `rects.size()` where its triangles show nothing: then texel (0, 0) stands for it
  /// where texels are packed, which is not opaque.
  std::vector<std::uint32_t> rect_of_vertex;
};

/// `shown`: for each face of the set whether it may show an opaque texel.
TexelPacking pack_texels(const TextureSet& set, const std::vector<std::uint8_t>& shown);

/// Texels of rows [first_row, first_row + rows) of what is on the GPU, row by row.
void fill_packed_rows(const TexelPacking& packing, const TexelReader& texels, int first_row, int rows,
                      std::vector<Texel>& filled);

/// Tiles that differ between textures of one size, as flags in their order.
std::vector<std::uint8_t> changed_tiles(const FeatureTexture& before, const FeatureTexture& after);
/// Whether a texel is opaque in `after` that is not in `before`.
bool newly_opaque(const FeatureTexture& before, const FeatureTexture& after);

}  // namespace rebake
