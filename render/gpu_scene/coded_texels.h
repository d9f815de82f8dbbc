#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh_ops/texture/texels.h"
#include "render/gpu_scene/packed_texels.h"

namespace rebake {

/// A block of 16 consecutive texels of a rectangle, as texel.glsl reads it. Opaque texels store eight channels, feat0.R
/// to feat1.A, as differences from the block's minimum, in as many bits as the range needs. Texels are numbered column
/// by column in strips of 4 rows (the last of up to 7), in alternating directions, so that a block is compact.
struct TexelBlock {
  /// Bits 0 … 15: opaque texels; bits 16 … 31: low 16 of 24 bits of widths, 3 bits per channel, where 7 means 8 bits.
  std::uint32_t opaque_and_widths = 0;
  /// Bits 0 … 7: high 8 bits of widths; bits 8 … 31: index of the 64-bit word where the data begin.
  std::uint32_t widths_and_word = 0;
  std::array<std::uint8_t, 8> least{};  ///< minimum per channel
  bool operator==(const TexelBlock&) const = default;
};
static_assert(sizeof(TexelBlock) == 16);

/// Texels of rectangles in lossless blocks. Takes about half the memory for trained features, which vary little between
/// neighbouring texels. Transparent texels store no data.
struct CodedTexels {
  /// Block 0 has no opaque texel; the blocks of all rectangles follow in order.
  std::vector<TexelBlock> blocks{TexelBlock{}};
  std::vector<std::uint64_t> words;  ///< data of the blocks
  /// Per rectangle: indices of its first block and first word. One more entry gives the end.
  std::vector<std::uint32_t> first_block{1}, first_word{0};
};

/// Maximum number of 64-bit words that blocks can address: 128 MiB of data.
inline constexpr std::size_t max_coded_words = std::size_t{1} << 24;

/// Codes rectangles of a texture. `rects`: roughly in the order of the texture's tiles, to unpack tiles rarely.
/// Throws std::length_error if the data exceed max_coded_words.
CodedTexels coded(const std::vector<PackedRect>& rects, const FeatureTexture& texels);

/// Appends the blocks and data of a rectangle. Blocks address the data as if they began at word `first_word`.
void append_coded(const PackedRect& rect, const TexelReader& texels, std::size_t first_word,
                  std::vector<TexelBlock>& blocks, std::vector<std::uint64_t>& words);

/// Texel (x, y) of rectangle `number`, relative to its corner; all zeros if it is transparent. Reference implementation
/// of texel.glsl.
Texel decoded(const CodedTexels& coded, const PackedRect& rect, std::size_t number, int x, int y);

}  // namespace rebake
