#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh_ops/texture/texels.h"
#include "render/gpu_scene/packed_texels.h"

namespace rebake {

/// 16 texels of a rectangle, as texel.glsl reads them. A rectangle is cut into strips of four rows, the last one of up
/// to seven; texels are numbered column by column along one strip and back along the next, so that those of a block are
/// neighbours. Only opaque ones have data: the eight channels from feat0.R to feat1.A, each in as many bits as the
/// block's values of it differ in.
struct TexelBlock {
  std::uint32_t opaque_and_widths = 0;  ///< a bit for each texel; from bit 16 on the first 16 of `widths`
  std::uint32_t widths_and_word =
      0;  ///< the last 8 of `widths`; from bit 8 on the word of 64 bits where its data begin
  std::array<std::uint8_t, 8> least{};  ///< of each channel the least value, which its bits count from
  bool operator==(const TexelBlock&) const = default;
};
static_assert(sizeof(TexelBlock) == 16);

/// Texels of rectangles, coded without loss: about half their memory for features that were trained, which change
/// little from texel to texel, and none for what is not opaque.
struct CodedTexels {
  /// Block 0 has no opaque texel; then those of one rectangle after the other.
  std::vector<TexelBlock> blocks{TexelBlock{}};
  std::vector<std::uint64_t> words;  ///< of data
  /// For each rectangle, and behind the last one.
  std::vector<std::uint32_t> first_block{1}, first_word{0};
};

/// Words that a block can point to; 128 MiB of data.
inline constexpr std::size_t most_coded_words = std::size_t{1} << 24;

/// `rects` in about the order of the texture's tiles. Throws std::length_error where they take more than
/// most_coded_words.
CodedTexels coded(const std::vector<PackedRect>& rects, const FeatureTexture& texels);

/// Appends a rectangle's blocks and data; the data are to lie from `first_word` on.
void append_coded(const PackedRect& rect, const TexelReader& texels, std::size_t first_word,
                  std::vector<TexelBlock>& blocks, std::vector<std::uint64_t>& words);

/// Texel (x, y) of a rectangle, counted from its corner; one of zeros where it is not opaque. What texel.glsl does.
Texel decoded(const CodedTexels& coded, const PackedRect& rect, std::size_t number, int x, int y);

}  // namespace rebake
