#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string_view>

namespace rebake {

/// Largest side of feature images, in pixels.
constexpr int largest_png_side = 16384;

/// Sequential decoder of an 8-bit RGBA image, from the top row on.
class RgbaRows {
 public:
  virtual ~RgbaRows() = default;
  RgbaRows(const RgbaRows&) = delete;
  RgbaRows& operator=(const RgbaRows&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }

  /// Decodes the next `count` rows, or all that are left. Throws FileError if the file is truncated or damaged.
  virtual void read(int count) = 0;
  /// The 4·width() bytes of row `k` of the rows just decoded.
  virtual const std::uint8_t* row(int k) const = 0;
  /// Number of bytes at the beginning of the file that will not be read again.
  virtual std::size_t bytes_consumed() const { return 0; }

 protected:
  RgbaRows(int width, int height) : width_(width), height_(height) {}

 private:
  int width_, height_;
};

/// Opens a non-interlaced 8-bit RGBA PNG of at most largest_png_side² pixels, the format of feature textures; returns
/// null for other files. ISA-L inflates it and filters are reversed for four rows together: 4.3 ms of
/// processor time for a feature image of the ficus, against 10.3 by libspng and 11.2 by OpenImageIO
/// (tests/benchmarks/png_benchmarks.cpp). Colour-space chunks are ignored. `bytes` and `name` must outlive the result.
/// Throws FileError for damaged files.
std::unique_ptr<RgbaRows> open_rgba_png(std::string_view bytes, const std::filesystem::path& name);

}  // namespace rebake
