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

/// One texel of both feature images, with the bytes of the files.
struct Texel {
  std::array<std::uint8_t, 4> feat0{};
  std::array<std::uint8_t, 4> feat1{};

  /// Opacity is stored in feat0.R; the images' alpha channels hold features 3 and 7.
  bool opaque() const { return feat0[0] != 0; }
  bool operator==(const Texel&) const = default;
};

/// Encoding of features 3 and 7 in the images' alpha channels A.
enum class AlphaCode {
  halved,  ///< split folders: decoded value = 2·A/255 − 1
  plain,   ///< unsplit folders: decoded value = A/255
};

/// The transparent texel that fills unused atlas space.
Texel empty_texel(AlphaCode code);

/// The 8 decoded features of an opaque texel, nominally 0 … 1.
std::array<double, 8> decode_features(const Texel& texel, AlphaCode code);

/// A square block of a feature texture's texels. Immutable and shared between scenes.
class TexelTile {
 public:
  static constexpr int size = 256;
  using Texels = std::vector<Texel>;  ///< size × size, row-major, row 0 at the top of the image

  /// `pack`: compress the texels with LZ4 to about half the memory, if that saves at least a tenth.
  TexelTile(Texels texels, bool pack);

  /// Opacity of texel (x, y) of the tile; does not unpack.
  bool opaque(unsigned x, unsigned y) const { return (opaque_[y * words + x / 64] >> x % 64 & 1) != 0; }
  std::uint32_t opaque_count() const { return opaque_count_; }
  /// Whether any texel is opaque here but not in `other`.
  bool more_opaque_than(const TexelTile& other) const;
  /// The texels; unpacked to a new copy if the tile is packed.
  std::shared_ptr<const Texels> texels() const;
  std::uint64_t memory() const;  ///< bytes

 private:
  static constexpr unsigned words = size / 64;  // 64-bit words per row of flags
  std::shared_ptr<const Texels> plain_;         // null if packed
  std::string packed_;
  std::vector<std::uint64_t> opaque_;
  std::uint32_t opaque_count_ = 0;
};

/// Both feature images of one texture set, as shared copy-on-write tiles: an edit copies only the tiles that it
/// touches. Opacity can be read directly, texels through a TexelReader.
class FeatureTexture {
 public:
  /// Builds a packed texture while it is read. `fill_rows(y, count, rows)` writes `count` rows of `width` texels, from
  /// row y on. It is called for one row of tiles after the other, so the source need not be in memory as a whole.
  static FeatureTexture from_parts(int width, int height, AlphaCode code,
                                   const std::function<void(int y, int count, Texel* rows)>& fill_rows);
  /// Builds an unpacked texture. `fill_rows` as for from_parts(), but called from several threads at once.
  static FeatureTexture from_tile_rows(int width, int height, AlphaCode code,
                                       const std::function<void(int y, int count, Texel* rows)>& fill_rows);
  /// Builds an unpacked texture. `fill_row(y, row)` writes `width` texels of row y; it is called from several threads
  /// at once.
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
  /// Opacity at (u, v) under nearest sampling with clamping; v points up.
  bool opaque_at(double u, double v) const;
  /// Number of the tile that contains texel (x, y), in row-major order.
  std::size_t tile_number(int x, int y) const {
    // Unsigned, so that the division by a power of two is a shift: this is called per texel.
    const auto column = static_cast<unsigned>(x), row = static_cast<unsigned>(y);
    constexpr unsigned size = TexelTile::size;
    return static_cast<std::size_t>(row / size) * static_cast<unsigned>(tile_columns()) + column / size;
  }

  /// Edits a copy of a texture by copy-on-write: at() copies a tile on first access. Copied tiles are not packed.
  class Change {
   public:
    explicit Change(const FeatureTexture& from);
    Texel& at(int x, int y);
    bool touched() const;  ///< whether any tile was copied
    /// The changed texture. The Change must not be used afterwards.
    std::shared_ptr<const FeatureTexture> finish();

   private:
    std::shared_ptr<FeatureTexture> texture_;
    std::vector<TexelTile::Texels> copies_;  ///< per tile: its copy, or empty
  };

  std::uint64_t opaque_count() const;
  /// Memory in bytes; a tile that occurs several times in this texture counts once.
  std::uint64_t memory() const;

 private:
  FeatureTexture(int width, int height, AlphaCode code)
      : width_(width),
        height_(height),
        code_(code),
        tiles_(static_cast<std::size_t>(tile_columns()) * static_cast<std::size_t>(tile_rows())) {}
  /// Creates a tile from `count` rows of its row of tiles; each row has the texture's width.
  void set_tile(int tile_row, int column, int count, const Texel* rows, bool pack);

  /// Texel (x, y) at (u, v) under nearest sampling with clamping.
  std::array<int, 2> nearest(double u, double v) const;

  friend class TexelReader;
  int width_ = 0;
  int height_ = 0;
  AlphaCode code_ = AlphaCode::halved;
  std::vector<std::shared_ptr<const TexelTile>> tiles_;
};

/// Reads the texels of a texture. A tile is unpacked on first access and cached for the reader's lifetime. Thread-safe.
/// The texture must outlive the reader.
class TexelReader {
 public:
  explicit TexelReader(const FeatureTexture& texture);
  explicit TexelReader(FeatureTexture&&) = delete;

  const Texel& at(int x, int y) const { return *row_part(x, y); }
  /// Pointer to texel (x, y) and its right neighbours in the same tile: valid up to the next x that is a multiple of
  /// 256.
  const Texel* row_part(int x, int y) const {
    const auto column = static_cast<unsigned>(x), row = static_cast<unsigned>(y);
    constexpr unsigned size = TexelTile::size;
    const std::size_t number = texture_.tile_number(x, y);
    const Texel* texels = texels_[number].load(std::memory_order_acquire);
    if (texels == nullptr) texels = unpacked(number);
    return texels + static_cast<std::size_t>(row % size) * size + column % size;
  }
  /// The texel at (u, v) under nearest sampling with clamping; v points up.
  const Texel& sample(double u, double v) const;

 private:
  const Texel* unpacked(std::size_t number) const;

  const FeatureTexture& texture_;
  mutable std::vector<std::atomic<const Texel*>> texels_;  ///< per tile; null until unpacked
  mutable std::mutex mutex_;
  mutable std::vector<std::shared_ptr<const TexelTile::Texels>> held_;
};

}  // namespace rebake
