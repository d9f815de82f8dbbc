#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string_view>

namespace rebake {

/// Pixels a side that feature images may have.
constexpr int largest_png_side = 16384;

/// Rows of an image of 8-bit RGBA, decoded from its top on.
class RgbaRows {
 public:
  virtual ~RgbaRows() = default;
  RgbaRows(const RgbaRows&) = delete;
  RgbaRows& operator=(const RgbaRows&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }

  /// Decodes the next `count` rows, at most as many as are left. Throws FileError where the file is truncated or
  /// damaged.
  virtual void read(int count) = 0;
  /// The 4·width() bytes of one of the rows just read.
  virtual const std::uint8_t* row(int k) const = 0;
  /// How many of the file's first bytes are not read again.
  virtual std::size_t bytes_passed() const { return 0; }

 protected:
  RgbaRows(int width, int height) : width_(width), height_(height) {}

 private:
  int width_, height_;
};

/// A PNG of 8-bit RGBA without interlacing, of at most largest_png_side² pixels, as feature textures are; null for
/// other files. ISA-L inflates it and filters are undone for four rows at once: a 4080² image takes 0.1 s where libpng
/// takes 0.38. Bytes are kept, whatever colour chunks say. `bytes` and `name` have to stay. Throws FileError as reading
/// does.
std::unique_ptr<RgbaRows> open_rgba_png(std::string_view bytes, const std::filesystem::path& name);

}  // namespace rebake
