#include "render/gpu_scene/coded_texels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>

namespace rebake {

namespace {

constexpr std::size_t texels_per_block = 16;
constexpr int strip = 4;  // rows per strip
constexpr std::size_t channels = 8;
// Rows of tiles per parallel task.
constexpr int tile_rows_at_once = 4;

// The 3-bit code of a width: 7 means 8 bits and is used for values of 7 bits, too.
constexpr unsigned bits_of(unsigned code) { return code == 7 ? 8 : code; }
unsigned code_of(unsigned range) { return std::min<unsigned>(static_cast<unsigned>(std::bit_width(range)), 7); }

using Bytes = std::array<std::uint8_t, channels>;

Bytes bytes_of(const Texel& texel) { return std::bit_cast<Bytes>(texel); }

// The opaque texels of a block, and a mask of their positions.
struct Gathered {
  std::array<Bytes, texels_per_block> texels{};
  std::size_t count = 0;
  std::uint32_t opaque = 0;
};

// Stores a value of at most `count` bits at bit `bit` of zeroed words.
void put(std::vector<std::uint64_t>& words, std::size_t bit, std::uint64_t value, unsigned count) {
  if (count == 0) return;
  const std::size_t word = bit / 64, shift = bit % 64;
  words[word] |= value << shift;
  if (shift + count > 64) words[word + 1] |= value >> (64 - shift);
}

// Codes a block and appends it.
void append_block(const Gathered& of, std::size_t word, std::vector<TexelBlock>& blocks,
                  std::vector<std::uint64_t>& words) {
  TexelBlock block;
  if (of.count == 0) {
    blocks.push_back(block);
    return;
  }
  Bytes most = block.least = of.texels[0];
  for (std::size_t t = 1; t < of.count; ++t)
    for (std::size_t c = 0; c < channels; ++c) {
      block.least[c] = std::min(block.least[c], of.texels[t][c]);
      most[c] = std::max(most[c], of.texels[t][c]);
    }
  std::uint32_t widths = 0;
  std::array<unsigned, channels> places{};
  unsigned bits = 0;
  for (std::size_t c = 0; c < channels; ++c) {
    const unsigned code = code_of(static_cast<unsigned>(most[c] - block.least[c]));
    widths |= code << (3 * c);
    places[c] = bits;
    bits += bits_of(code);
  }
  block.opaque_and_widths = of.opaque | widths << 16;
  block.widths_and_word = widths >> 16 | static_cast<std::uint32_t>(word) << 8;
  blocks.push_back(block);
  const std::size_t at = words.size() * 64;
  words.resize(words.size() + (of.count * bits + 63) / 64, 0);
  for (std::size_t t = 0; t < of.count; ++t) {
    std::uint64_t value = 0;
    for (std::size_t c = 0; c < channels; ++c)
      if (const auto over = static_cast<std::uint64_t>(of.texels[t][c] - block.least[c]); over != 0)
        value |= over << places[c];
    put(words, at + t * bits, value, bits);
  }
}

// A strip of rows.
struct Strip {
  int top = 0, rows = 0;
  bool back = false;  // columns are numbered from right to left
};

Strip strip_of(const PackedRect& rect, int y) {
  const int last = std::max(rect.height / strip, 1) - 1, number = std::min(y / strip, last);
  return {number * strip, number == last ? rect.height - number * strip : strip, number % 2 != 0};
}

}  // namespace

void append_coded(const PackedRect& rect, const TexelReader& texels, std::size_t first_word,
                  std::vector<TexelBlock>& blocks, std::vector<std::uint64_t>& words) {
  const std::size_t begin = words.size();
  Gathered block;
  std::size_t seen = 0;
  const auto finish = [&] {
    append_block(block, words.size() - begin + first_word, blocks, words);
    block = {};
    seen = 0;
  };
  for (int top = 0; top < rect.height;) {
    const Strip strip = strip_of(rect, top);
    for (int k = 0; k < rect.width; ++k) {
      const int x = rect.x + (strip.back ? rect.width - 1 - k : k);
      for (int y = rect.y + top; y < rect.y + top + strip.rows; ++y) {
        if (const Texel& texel = texels.at(x, y); texel.opaque()) {
          block.opaque |= std::uint32_t{1} << seen;
          block.texels[block.count++] = bytes_of(texel);
        }
        if (++seen == texels_per_block) finish();
      }
    }
    top += strip.rows;
  }
  if (seen != 0) finish();
}

CodedTexels coded(const std::vector<PackedRect>& rects, const FeatureTexture& texels) {
  // Groups of consecutive rectangles that begin in the same rows of tiles.
  const auto rows_of = [](const PackedRect& rect) { return rect.y / (TexelTile::size * tile_rows_at_once); };
  std::vector<std::size_t> begins;
  for (std::size_t k = 0; k < rects.size(); ++k)
    if (k == 0 || rows_of(rects[k]) != rows_of(rects[k - 1])) begins.push_back(k);
  begins.push_back(rects.size());
  struct Part {
    std::vector<TexelBlock> blocks;
    std::vector<std::uint64_t> words;
    std::vector<std::size_t> blocks_before, words_before;  // per rectangle
  };
  std::vector<Part> parts(begins.size() - 1);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t p) {
    const TexelReader reader(texels);
    Part& part = parts[p];
    for (std::size_t k = begins[p]; k < begins[p + 1]; ++k) {
      part.blocks_before.push_back(part.blocks.size());
      part.words_before.push_back(part.words.size());
      append_coded(rects[k], reader, part.words.size(), part.blocks, part.words);
      if (part.words.size() > max_coded_words) throw std::length_error("coded texels of a texture set exceed 128 MiB");
    }
  });
  CodedTexels result;
  result.first_block.clear();
  result.first_word.clear();
  std::size_t blocks = 1, words = 0;
  for (const Part& part : parts) {
    for (std::size_t k = 0; k < part.blocks_before.size(); ++k) {
      result.first_block.push_back(static_cast<std::uint32_t>(blocks + part.blocks_before[k]));
      result.first_word.push_back(static_cast<std::uint32_t>(words + part.words_before[k]));
    }
    blocks += part.blocks.size();
    words += part.words.size();
    if (words > max_coded_words) throw std::length_error("coded texels of a texture set exceed 128 MiB");
  }
  result.first_block.push_back(static_cast<std::uint32_t>(blocks));
  result.first_word.push_back(static_cast<std::uint32_t>(words));
  result.blocks.reserve(blocks);
  result.words.reserve(words);
  for (Part& part : parts) {
    const auto before = static_cast<std::uint32_t>(result.words.size());
    for (TexelBlock& block : part.blocks) {
      if ((block.opaque_and_widths & 0xffffU) != 0) block.widths_and_word += before << 8;
      result.blocks.push_back(block);
    }
    result.words.insert(result.words.end(), part.words.begin(), part.words.end());
    part = {};
  }
  return result;
}

Texel decoded(const CodedTexels& coded, const PackedRect& rect, std::size_t number, int x, int y) {
  const Strip strip = strip_of(rect, y);
  const auto place = static_cast<std::size_t>(strip.top * rect.width +
                                              (strip.back ? rect.width - 1 - x : x) * strip.rows + y - strip.top);
  const TexelBlock& block = coded.blocks[coded.first_block[number] + place / texels_per_block];
  const std::uint32_t bit = std::uint32_t{1} << place % texels_per_block;
  const std::uint32_t opaque = block.opaque_and_widths & 0xffffU;
  if ((opaque & bit) == 0) return {};
  const std::uint32_t widths = block.opaque_and_widths >> 16 | (block.widths_and_word & 0xffU) << 16;
  unsigned bits = 0;
  for (std::size_t c = 0; c < channels; ++c) bits += bits_of(widths >> (3 * c) & 7);
  std::size_t at =
      std::size_t{block.widths_and_word >> 8} * 64 + static_cast<std::size_t>(std::popcount(opaque & (bit - 1))) * bits;
  Bytes bytes = block.least;
  for (std::size_t c = 0; c < channels; ++c) {
    unsigned over = 0;
    const unsigned width = bits_of(widths >> (3 * c) & 7);
    for (unsigned k = 0; k < width; ++k, ++at) over |= static_cast<unsigned>(coded.words[at / 64] >> at % 64 & 1) << k;
    bytes[c] = static_cast<std::uint8_t>(bytes[c] + over);
  }
  return std::bit_cast<Texel>(bytes);
}

}  // namespace rebake
