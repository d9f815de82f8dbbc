#include "mesh_ops/texture/texels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace rebake {

namespace {

// Most of a real atlas is unused; one shared tile stands for all of that.
const std::shared_ptr<const TexelTile>& shared_empty_tile(AlphaCode code) {
  const auto make = [](AlphaCode c) {
    auto tile = std::make_shared<TexelTile>();
    tile->texels.assign(TexelTile::size * TexelTile::size, empty_texel(c));
    return std::shared_ptr<const TexelTile>(std::move(tile));
  };
  static const std::shared_ptr<const TexelTile> halved = make(AlphaCode::halved);
  static const std::shared_ptr<const TexelTile> plain = make(AlphaCode::plain);
  return code == AlphaCode::halved ? halved : plain;
}

}  // namespace

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

void FeatureTexture::set_tile(int tile_row, int column, int count, const Texel* rows) {
  const Texel empty = empty_texel(code_);
  const int left = column * TexelTile::size, columns = std::min(TexelTile::size, width_ - left);
  std::shared_ptr<TexelTile> tile;
  for (int y = 0; y < count; ++y) {
    const Texel* begin = rows + static_cast<std::ptrdiff_t>(y) * width_ + left;
    const Texel* end = begin + columns;
    if (!tile) {
      if (std::all_of(begin, end, [&](const Texel& t) { return t == empty; })) continue;
      tile = std::make_shared<TexelTile>(*shared_empty_tile(code_));
    }
    std::copy(begin, end, tile->texels.begin() + y * TexelTile::size);
    tile->opaque_count +=
        static_cast<std::uint32_t>(std::count_if(begin, end, [](const Texel& t) { return t.opaque(); }));
  }
  tiles_[static_cast<std::size_t>(tile_row) * static_cast<std::size_t>(tile_columns()) +
         static_cast<std::size_t>(column)] =
      tile ? std::shared_ptr<const TexelTile>(std::move(tile)) : shared_empty_tile(code_);
}

// Textures are made within other parallel work too. Where that is stopped, by an error of another part of it, work
// nested in it returns with tiles missing; so these loops are in contexts of their own.

FeatureTexture FeatureTexture::from_rows(int width, int height, AlphaCode code,
                                         const std::function<void(int, Texel*)>& fill_row) {
  FeatureTexture texture(width, height, code);
  tbb::task_group_context whole(tbb::task_group_context::isolated);
  tbb::parallel_for(
      0, texture.tile_rows(),
      [&](int tile_row) {
        const int first = tile_row * TexelTile::size, count = std::min(TexelTile::size, height - first);
        std::vector<Texel> rows(static_cast<std::size_t>(width) * static_cast<std::size_t>(count));
        for (int y = 0; y < count; ++y)
          fill_row(first + y, &rows[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)]);
        for (int column = 0; column < texture.tile_columns(); ++column)
          texture.set_tile(tile_row, column, count, rows.data());
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
        0, texture.tile_columns(), [&](int column) { texture.set_tile(tile_row, column, count, rows.data()); }, whole);
  }
  return texture;
}

const Texel& FeatureTexture::sample(double u, double v) const {
  const int x = std::clamp(static_cast<int>(std::floor(std::clamp(u, -1.0, 2.0) * width_)), 0, width_ - 1);
  const int y = std::clamp(static_cast<int>(std::floor((1 - std::clamp(v, -1.0, 2.0)) * height_)), 0, height_ - 1);
  return at(x, y);
}

FeatureTexture::Change::Change(const FeatureTexture& from)
    : texture_(std::make_shared<FeatureTexture>(from)), fresh_(from.tiles_.size()) {}

Texel& FeatureTexture::Change::at(int x, int y) {
  const auto tile = static_cast<std::size_t>(y / TexelTile::size) * static_cast<std::size_t>(texture_->tile_columns()) +
                    static_cast<std::size_t>(x / TexelTile::size);
  if (!fresh_[tile]) fresh_[tile] = std::make_shared<TexelTile>(*texture_->tiles_[tile]);
  return fresh_[tile]->texels[static_cast<std::size_t>(y % TexelTile::size) * TexelTile::size +
                              static_cast<std::size_t>(x % TexelTile::size)];
}

bool FeatureTexture::Change::touched() const {
  return std::any_of(fresh_.begin(), fresh_.end(), [](const auto& tile) { return tile != nullptr; });
}

std::shared_ptr<const FeatureTexture> FeatureTexture::Change::finish() {
  for (std::size_t k = 0; k < fresh_.size(); ++k) {
    if (!fresh_[k]) continue;
    fresh_[k]->opaque_count = static_cast<std::uint32_t>(
        std::count_if(fresh_[k]->texels.begin(), fresh_[k]->texels.end(), [](const Texel& t) { return t.opaque(); }));
    texture_->tiles_[k] = std::move(fresh_[k]);
  }
  return std::move(texture_);
}

std::uint64_t FeatureTexture::opaque_count() const {
  std::uint64_t count = 0;
  for (const auto& tile : tiles_) count += tile->opaque_count;
  return count;
}

std::uint64_t FeatureTexture::memory() const {
  std::set<const TexelTile*> distinct;
  for (const auto& tile : tiles_) distinct.insert(tile.get());
  return distinct.size() * TexelTile::size * TexelTile::size * sizeof(Texel);
}

}  // namespace rebake
