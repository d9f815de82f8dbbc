#include "mesh_ops/texture/texels.h"

#include <lz4.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>
#include <stdexcept>

namespace rebake {

namespace {

constexpr std::size_t texel_count = static_cast<std::size_t>(TexelTile::size) * TexelTile::size;

// Most of a real atlas is unused; all empty tiles share one.
const std::shared_ptr<const TexelTile>& shared_empty_tile(AlphaCode code) {
  const auto make = [](AlphaCode c) {
    return std::make_shared<const TexelTile>(TexelTile::Texels(texel_count, empty_texel(c)), false);
  };
  static const std::shared_ptr<const TexelTile> halved = make(AlphaCode::halved);
  static const std::shared_ptr<const TexelTile> plain = make(AlphaCode::plain);
  return code == AlphaCode::halved ? halved : plain;
}

}  // namespace

TexelTile::TexelTile(Texels texels, bool pack) : opaque_(static_cast<std::size_t>(size) * words, 0) {
  for (std::size_t k = 0; k < texel_count; ++k)
    opaque_[k / 64] |= static_cast<std::uint64_t>(texels[k].opaque() ? 1 : 0) << k % 64;
  for (const std::uint64_t flags : opaque_) opaque_count_ += static_cast<std::uint32_t>(std::popcount(flags));
  constexpr int bytes = static_cast<int>(texel_count * sizeof(Texel));
  if (pack) {
    // Real features compress to 0.50 … 0.55 of their size. Above 0.9 the tile stays unpacked.
    std::string packed(bytes / 10 * 9, '\0');
    constexpr int hurry = 2;
    const int written = LZ4_compress_fast(reinterpret_cast<const char*>(texels.data()), packed.data(), bytes,
                                          static_cast<int>(packed.size()), hurry);
    if (written > 0) packed_.assign(packed, 0, static_cast<std::size_t>(written));
  }
  if (packed_.empty()) plain_ = std::make_shared<const Texels>(std::move(texels));
}

bool TexelTile::more_opaque_than(const TexelTile& other) const {
  for (std::size_t k = 0; k < opaque_.size(); ++k)
    if ((opaque_[k] & ~other.opaque_[k]) != 0) return true;
  return false;
}

std::shared_ptr<const TexelTile::Texels> TexelTile::texels() const {
  if (plain_) return plain_;
  auto texels = std::make_shared<Texels>(texel_count);
  constexpr int bytes = static_cast<int>(texel_count * sizeof(Texel));
  if (LZ4_decompress_safe(packed_.data(), reinterpret_cast<char*>(texels->data()), static_cast<int>(packed_.size()),
                          bytes) != bytes)
    throw std::logic_error("a packed texel tile is corrupt in memory");
  return texels;
}

std::uint64_t TexelTile::memory() const {
  return packed_.size() + (plain_ ? plain_->size() * sizeof(Texel) : 0) + opaque_.size() * sizeof(opaque_[0]);
}

Texel empty_texel(AlphaCode code) {
  Texel texel;
  texel.feat0[3] = texel.feat1[3] = code == AlphaCode::halved ? 128 : 0;
  return texel;
}

std::array<double, 8> decode_features(const Texel& texel, AlphaCode code) {
  const auto alpha = [code](std::uint8_t a) { return code == AlphaCode::halved ? 2 * a / 255.0 - 1 : a / 255.0; };
  return {texel.feat0[0] / 255.0, texel.feat0[1] / 255.0, texel.feat0[2] / 255.0, alpha(texel.feat0[3]),
          texel.feat1[0] / 255.0, texel.feat1[1] / 255.0, texel.feat1[2] / 255.0, alpha(texel.feat1[3])};
}

void FeatureTexture::set_tile(int tile_row, int column, int count, const Texel* rows, bool pack) {
  const Texel empty = empty_texel(code_);
  const int left = column * TexelTile::size, columns = std::min(TexelTile::size, width_ - left);
  TexelTile::Texels tile;
  for (int y = 0; y < count; ++y) {
    const Texel* begin = rows + static_cast<std::ptrdiff_t>(y) * width_ + left;
    const Texel* end = begin + columns;
    if (tile.empty()) {
      if (std::all_of(begin, end, [&](const Texel& t) { return t == empty; })) continue;
      tile.assign(texel_count, empty);
    }
    std::copy(begin, end, tile.begin() + y * TexelTile::size);
  }
  tiles_[static_cast<std::size_t>(tile_row) * static_cast<std::size_t>(tile_columns()) +
         static_cast<std::size_t>(column)] =
      tile.empty() ? shared_empty_tile(code_) : std::make_shared<const TexelTile>(std::move(tile), pack);
}

// Textures may be built inside other parallel work. If an error cancels that work, nested loops of the same context
// return with tiles missing; so these loops have isolated contexts.

FeatureTexture FeatureTexture::from_rows(int width, int height, AlphaCode code,
                                         const std::function<void(int, Texel*)>& fill_row) {
  return from_tile_rows(width, height, code, [&](int first, int count, Texel* rows) {
    for (int y = 0; y < count; ++y) fill_row(first + y, rows + static_cast<std::ptrdiff_t>(y) * width);
  });
}

FeatureTexture FeatureTexture::from_tile_rows(int width, int height, AlphaCode code,
                                              const std::function<void(int, int, Texel*)>& fill_rows) {
  FeatureTexture texture(width, height, code);
  tbb::task_group_context whole(tbb::task_group_context::isolated);
  tbb::parallel_for(
      0, texture.tile_rows(),
      [&](int tile_row) {
        const int first = tile_row * TexelTile::size, count = std::min(TexelTile::size, height - first);
        std::vector<Texel> rows(static_cast<std::size_t>(width) * static_cast<std::size_t>(count));
        fill_rows(first, count, rows.data());
        for (int column = 0; column < texture.tile_columns(); ++column)
          texture.set_tile(tile_row, column, count, rows.data(), false);
      },
      whole);
  return texture;
}

FeatureTexture FeatureTexture::from_parts(int width, int height, AlphaCode code,
                                          const std::function<void(int, int, Texel*)>& fill_rows) {
  FeatureTexture texture(width, height, code);
  std::vector<Texel> rows(static_cast<std::size_t>(width) *
                          static_cast<std::size_t>(std::min(TexelTile::size, height)));
  for (int tile_row = 0; tile_row < texture.tile_rows(); ++tile_row) {
    const int first = tile_row * TexelTile::size, count = std::min(TexelTile::size, height - first);
    fill_rows(first, count, rows.data());
    tbb::task_group_context whole(tbb::task_group_context::isolated);
    tbb::parallel_for(
        0, texture.tile_columns(), [&](int column) { texture.set_tile(tile_row, column, count, rows.data(), true); },
        whole);
  }
  return texture;
}

std::array<int, 2> FeatureTexture::nearest(double u, double v) const {
  return {std::clamp(static_cast<int>(std::floor(std::clamp(u, -1.0, 2.0) * width_)), 0, width_ - 1),
          std::clamp(static_cast<int>(std::floor((1 - std::clamp(v, -1.0, 2.0)) * height_)), 0, height_ - 1)};
}
bool FeatureTexture::opaque_at(double u, double v) const {
  const auto [x, y] = nearest(u, v);
  return opaque(x, y);
}

FeatureTexture::Change::Change(const FeatureTexture& from)
    : texture_(std::make_shared<FeatureTexture>(from)), copies_(from.tiles_.size()) {}

Texel& FeatureTexture::Change::at(int x, int y) {
  const std::size_t tile = texture_->tile_number(x, y);
  if (copies_[tile].empty()) copies_[tile] = *texture_->tiles_[tile]->texels();
  return copies_[tile][static_cast<std::size_t>(y % TexelTile::size) * TexelTile::size +
                       static_cast<std::size_t>(x % TexelTile::size)];
}

bool FeatureTexture::Change::touched() const {
  return std::any_of(copies_.begin(), copies_.end(), [](const auto& texels) { return !texels.empty(); });
}

std::shared_ptr<const FeatureTexture> FeatureTexture::Change::finish() {
  for (std::size_t k = 0; k < copies_.size(); ++k)
    if (!copies_[k].empty()) texture_->tiles_[k] = std::make_shared<const TexelTile>(std::move(copies_[k]), false);
  return std::move(texture_);
}

TexelReader::TexelReader(const FeatureTexture& texture)
    : texture_(texture), texels_(texture.tiles_.size()), held_(texture.tiles_.size()) {}

const Texel* TexelReader::unpacked(std::size_t number) const {
  // Two threads may unpack the same tile; the first result is used.
  auto texels = texture_.tiles_[number]->texels();
  const std::scoped_lock lock(mutex_);
  if (!held_[number]) {
    held_[number] = std::move(texels);
    texels_[number].store(held_[number]->data(), std::memory_order_release);
  }
  return held_[number]->data();
}

const Texel& TexelReader::sample(double u, double v) const {
  const auto [x, y] = texture_.nearest(u, v);
  return at(x, y);
}

std::uint64_t FeatureTexture::opaque_count() const {
  std::uint64_t count = 0;
  for (const auto& tile : tiles_) count += tile->opaque_count();
  return count;
}

std::uint64_t FeatureTexture::memory() const {
  std::set<const TexelTile*> distinct;
  for (const auto& tile : tiles_) distinct.insert(tile.get());
  std::uint64_t bytes = 0;
  for (const TexelTile* tile : distinct) bytes += tile->memory();
  return bytes;
}

}  // namespace rebake
