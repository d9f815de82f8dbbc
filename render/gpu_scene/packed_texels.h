#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// A rectangle of texels in a texture, and its position in the packed texture on the GPU.
struct PackedRect {
  std::uint16_t x = 0, y = 0;  ///< corner in the texture, row 0 at the top
  std::uint16_t width = 1, height = 1;
  std::uint16_t place_x = 0, place_y = 0;  ///< corner in the packed texture
  bool operator==(const PackedRect&) const = default;
};

/// Packing of a texture set's texels on the GPU: one rectangle per connected component of triangles, the bounding
/// rectangle of its texels. Components without opaque texels have none.
struct TexelPacking {
  int width = 1, height = 1;      ///< of the packed texture, in texels
  bool whole = false;             ///< the whole texture is stored unpacked, because packing would save too little
  std::vector<PackedRect> rects;  ///< sorted by the tile of their corner
  /// Per vertex: index of its rectangle, or `rects.size()` if its component has none. If packed, such vertices use
  /// texel (0, 0), which is transparent.
  std::vector<std::uint32_t> rect_of_vertex;
};

/// Packs the texels of a set. `shown`: per face, 1 if it may show an opaque texel, else 0.
TexelPacking pack_texels(const TextureSet& set, const std::vector<std::uint8_t>& shown);

/// Fills rows [first_row, first_row + rows) of the packed texture into `filled`, row by row.
void fill_packed_rows(const TexelPacking& packing, const TexelReader& texels, int first_row, int rows,
                      std::vector<Texel>& filled);

/// Flag per tile in row-major order: 1 if two textures of the same size do not share the tile.
std::vector<std::uint8_t> changed_tiles(const FeatureTexture& before, const FeatureTexture& after);
/// Whether any texel is opaque in `after` but not in `before`. Both have the same size.
bool any_newly_opaque(const FeatureTexture& before, const FeatureTexture& after);

}  // namespace rebake
