#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
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

/// A square block of texels; part of a picture, shared between scenes. Immutable.
class TexelTile {
 public:
  static constexpr int size = 256;
  using Texels = std::vector<Texel>;  ///< size × size, row-major, row 0 at the top of the image

  /// `pack`: to hold it in about half the memory (LZ4), where that saves any.
  TexelTile(Texels texels, bool pack);

  /// Of a place within the tile. Needs nothing unpacked.
  bool opaque(unsigned x, unsigned y) const { return (opaque_[y * words + x / 64] >> x % 64 & 1) != 0; }
  std::uint32_t opaque_count() const { return opaque_count_; }
  /// Whether a texel is opaque that is not in another tile.
  bool more_opaque_than(const TexelTile& other) const;
  /// Its texels: a copy where they are packed, which takes a seventh of a millisecond.
  std::shared_ptr<const Texels> texels() const;
  std::uint64_t memory() const;  ///< bytes

 private:
  static constexpr unsigned words = size / 64;  // a row of flags
  std::shared_ptr<const Texels> plain_;         // null where packed
  std::string packed_;
  std::vector<std::uint64_t> opaque_;
  std::uint32_t opaque_count_ = 0;
};

/// Both feature images of one texture set, as shared tiles: an edit copies the tiles it touches only. Which texels are
/// opaque can be asked at once; what they are, of a TexelReader.
class FeatureTexture {
 public:
  /// Packed, as it is read. `fill_rows(y, count, rows)` writes `count` rows from row y on, `width` texels each; it is
  /// called for one part of the texture after the other, so that what they come from need not be there whole.
  static FeatureTexture from_parts(int width, int height, AlphaCode code,
                                   const std::function<void(int y, int count, Texel* rows)>& fill_rows);
  /// Not packed. `fill_rows` as above, but it is called from several threads at once.
  static FeatureTexture from_tile_rows(int width, int height, AlphaCode code,
                                       const std::function<void(int y, int count, Texel* rows)>& fill_rows);
  /// Not packed. `fill_row(y, row)` writes `width` texels of row y; it is called from several threads at once.
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
  bool opaque(int x, int y) const {
    const auto column = static_cast<unsigned>(x), row = static_cast<unsigned>(y);
    constexpr unsigned size = TexelTile::size;
    return tiles_[tile_number(x, y)]->opaque(column % size, row % size);
  }
  /// Of the texel that nearest sampling with clamping finds at (u, v), v pointing up.
  bool opaque_at(double u, double v) const;
  /// The number of the tile that holds a texel, row by row.
  std::size_t tile_number(int x, int y) const {
    // Unsigned, so that dividing by the power of two is a shift: this is called for every texel.
    const auto column = static_cast<unsigned>(x), row = static_cast<unsigned>(y);
    constexpr unsigned size = TexelTile::size;
    return static_cast<std::size_t>(row / size) * static_cast<unsigned>(tile_columns()) + column / size;
  }

  /// A copy in the making: tiles are copied when one of their texels is first asked for, and are not packed then.
  class Change {
   public:
    explicit Change(const FeatureTexture& from);
    Texel& at(int x, int y);
    bool touched() const;
    /// The changed texture. The change is spent.
    std::shared_ptr<const FeatureTexture> finish();

   private:
    std::shared_ptr<FeatureTexture> texture_;
    std::vector<TexelTile::Texels> fresh_;  ///< empty where not touched
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
  void set_tile(int tile_row, int column, int count, const Texel* rows, bool pack);

  /// The texel that nearest sampling with clamping finds.
  std::array<int, 2> nearest(double u, double v) const;

  friend class TexelReader;
  int width_ = 0;
  int height_ = 0;
  AlphaCode code_ = AlphaCode::halved;
  std::vector<std::shared_ptr<const TexelTile>> tiles_;
};

/// Reads a texture's texels. Tiles are unpacked when one of their texels is first asked for, and stay so as long as the
/// reader lives. Callable from any thread; the texture must outlive it.
class TexelReader {
 public:
  explicit TexelReader(const FeatureTexture& texture);
  explicit TexelReader(FeatureTexture&&) = delete;

  const Texel& at(int x, int y) const { return *row_part(x, y); }
  /// Texel (x, y), followed by those to its right as far as the tile reaches: x up to the next multiple of 256.
  const Texel* row_part(int x, int y) const {
    const auto column = static_cast<unsigned>(x), row = static_cast<unsigned>(y);
    constexpr unsigned size = TexelTile::size;
    const std::size_t number = texture_.tile_number(x, y);
    const Texel* texels = texels_[number].load(std::memory_order_acquire);
    if (texels == nullptr) texels = unpacked(number);
    return texels + static_cast<std::size_t>(row % size) * size + column % size;
  }
  /// The texel that nearest sampling with clamping finds at (u, v), v pointing up.
  const Texel& sample(double u, double v) const;

 private:
  const Texel* unpacked(std::size_t number) const;

  const FeatureTexture& texture_;
  mutable std::vector<std::atomic<const Texel*>> texels_;  ///< null where not asked for yet
  mutable std::mutex mutex_;
  mutable std::vector<std::shared_ptr<const TexelTile::Texels>> held_;
};

}  // namespace rebake
