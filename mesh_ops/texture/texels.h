#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace rebake {

/// One texel of both feature images, byte for byte as on disk.
struct Texel {
  std::array<std::uint8_t, 4> feat0{};
  std::array<std::uint8_t, 4> feat1{};

  /// Opacity is in feat0.R, not in the images' alpha, which is a feature.
  bool opaque() const { return feat0[0] != 0; }
  bool operator==(const Texel&) const = default;
};

/// How feature 3 and 7 are stored in the images' alpha channel.
enum class AlphaCode {
  halved,  ///< split folders: decoded value = 2·A/255 − 1
  plain,   ///< unsplit folders: decoded value = A/255
};

/// What unused atlas space holds.
Texel empty_texel(AlphaCode code);

/// The 8 decoded features of an opaque texel.
std::array<double, 8> decode_features(const Texel& texel, AlphaCode code);

/// A square block of texels; part of a picture, shared between scenes.
struct TexelTile {
  static constexpr int size = 256;
  std::vector<Texel> texels;  ///< size × size, row-major, row 0 at the top of the image
  std::uint32_t opaque_count = 0;
};

/// Both feature images of one texture set, as shared tiles: an edit copies the tiles it touches only.
class FeatureTexture {
 public:
  /// `fill_rows(y, count, rows)` writes `count` rows from row y on, `width` texels each; it is called for one part of
  /// the texture after the other, so that what they come from need not be there whole.
  static FeatureTexture from_parts(int width, int height, AlphaCode code,
                                   const std::function<void(int y, int count, Texel* rows)>& fill_rows);
  /// `fill_row(y, row)` writes `width` texels of row y; it is called from several threads at once.
  static FeatureTexture from_rows(int width, int height, AlphaCode code,
                                  const std::function<void(int y, Texel* row)>& fill_row);

  int width() const { return width_; }
  int height() const { return height_; }
  AlphaCode alpha_code() const { return code_; }
  int tile_columns() const { return (width_ + TexelTile::size - 1) / TexelTile::size; }
  int tile_rows() const { return (height_ + TexelTile::size - 1) / TexelTile::size; }
  const std::shared_ptr<const TexelTile>& tile(int column, int row) const {
    return tiles_[static_cast<std::size_t>(row) * static_cast<std::size_t>(tile_columns()) +
                  static_cast<std::size_t>(column)];
  }
  const Texel& at(int x, int y) const { return *row_part(x, y); }
  /// Texel (x, y), followed by those to its right as far as the tile reaches: x up to the next multiple of 256.
  const Texel* row_part(int x, int y) const {
    // Unsigned, so that dividing by the power of two is a shift: this is called for every texel.
    const auto column = static_cast<unsigned>(x), row = static_cast<unsigned>(y);
    constexpr unsigned size = TexelTile::size;
    return &tiles_[static_cast<std::size_t>(row / size) * static_cast<unsigned>(tile_columns()) + column / size]
                ->texels[static_cast<std::size_t>(row % size) * size + column % size];
  }
  /// The texel that nearest sampling with clamping finds at (u, v), v pointing up.
  const Texel& sample(double u, double v) const;

  /// A copy in the making: tiles are copied when one of their texels is first asked for.
  class Change {
   public:
    explicit Change(const FeatureTexture& from);
    Texel& at(int x, int y);
    bool touched() const;
    /// The changed texture. The change is spent.
    std::shared_ptr<const FeatureTexture> finish();

   private:
    std::shared_ptr<FeatureTexture> texture_;
    std::vector<std::shared_ptr<TexelTile>> fresh_;  ///< null where not touched
  };

  std::uint64_t opaque_count() const;
  /// Bytes held, counting a tile that is shared within this texture once.
  std::uint64_t memory() const;

 private:
  FeatureTexture(int width, int height, AlphaCode code)
      : width_(width),
        height_(height),
        code_(code),
        tiles_(static_cast<std::size_t>(tile_columns()) * static_cast<std::size_t>(tile_rows())) {}
  /// Makes a tile from `count` rows of texels of its row of tiles, which lie the texture's width apart.
  void set_tile(int tile_row, int column, int count, const Texel* rows);

  int width_ = 0;
  int height_ = 0;
  AlphaCode code_ = AlphaCode::halved;
  std::vector<std::shared_ptr<const TexelTile>> tiles_;
};

}  // namespace rebake
