#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

// Decoding and encoding of general image files by OpenImageIO. It is in a separate module, loaded for the first such
// image: its 250 libraries take ten times as long to load as the rest of the program.

namespace rebake {

/// Size and pixel format of an image file.
struct PictureLayout {
  int width = 0, height = 0, channels = 0;
  /// Size of the whole image, of which the file may hold only a part.
  int whole_width = 0, whole_height = 0;
  bool part = false;        ///< whether the file holds only a part of the image
  bool floating = false;    ///< whether channels are floating-point numbers
  std::string type;         ///< data type of a channel, such as "uint8"
  std::string color_space;  ///< colour space according to the file or its format; may be empty
  int rows_at_once = 1;     ///< height of a tile, or 1: read() needs multiples of this
};

/// A decoded WebP image.
struct WebpImage {
  int width = 0, height = 0;
  bool lossless = false;             ///< whether it was compressed without loss
  std::vector<std::uint8_t> rgba{};  ///< row by row from the top
};

/// A channel of an OpenEXR file: "R", "normal.X".
struct FloatChannel {
  std::string name;
  bool half = false;  ///< 16-bit floats instead of 32-bit ones
};

/// Reads the rows of an open image file.
class PictureReader {
 public:
  explicit PictureReader(PictureLayout layout) : layout_(std::move(layout)) {}
  virtual ~PictureReader() = default;
  PictureReader(const PictureReader&) = delete;
  PictureReader& operator=(const PictureReader&) = delete;

  const PictureLayout& layout() const { return layout_; }

  /// Reads the first `channels` channels of `count` rows from row `first` on, interleaved. Integer channels are
  /// converted to 0 … 255 or 0 … 1. `first` must be a multiple of rows_at_once, and so must `count`, except at the last
  /// row. Returns false if the file is damaged; error() then gives the reason.
  virtual bool read(int first, int count, int channels, std::uint8_t* to) = 0;
  virtual bool read(int first, int count, int channels, float* to) = 0;
  /// Message of the last failed read().
  virtual std::string error() const = 0;

 private:
  PictureLayout layout_;
};

/// Interface of the module. If an image cannot be opened, functions return null and set `error` to the reason.
class PictureCodecs {
 public:
  virtual ~PictureCodecs() = default;
  PictureCodecs(const PictureCodecs&) = delete;
  PictureCodecs& operator=(const PictureCodecs&) = delete;

  /// Opens an image file of any known format. Colours are not premultiplied by alpha unless the format stores them so,
  /// or the file is a WebP.
  virtual std::unique_ptr<PictureReader> open(const std::filesystem::path& path, std::string& error) const = 0;
  /// Opens an image in memory in a format of OpenImageIO ("png", "jpeg"); `bytes` must outlive the reader. `name` is
  /// for messages.
  virtual std::unique_ptr<PictureReader> open_memory(const std::string& format, std::string_view bytes,
                                                     const std::string& name, std::string& error) const = 0;
  /// Decodes a WebP in memory as RGBA with the colours as stored, which OpenImageIO would multiply by alpha.
  virtual bool decode_webp(std::string_view bytes, WebpImage& image, std::string& error) const = 0;
  /// Encodes an 8-bit image of display colours, RGB or RGBA, interleaved, row 0 at the top, in a format of OpenImageIO
  /// ("jpeg", "webp"): without loss except by JPEG (quality 95, no subsampling). Returns false and sets `error` if that
  /// fails.
  virtual bool encode(const std::string& format, int width, int height, int channels, const std::uint8_t* pixels,
                      std::string& bytes, std::string& error) const = 0;
  /// Encodes an OpenEXR file with these channels, interleaved, row 0 at the top, and text attributes.
  virtual bool encode_exr(int width, int height, const std::vector<FloatChannel>& channels,
                          const std::vector<std::pair<std::string, std::string>>& attributes, const float* pixels,
                          std::string& bytes, std::string& error) const = 0;

 protected:
  PictureCodecs() = default;
};

/// Loads the module on the first call. Throws FileError, for the file `picture`, if the module is missing.
const PictureCodecs& picture_codecs(const std::filesystem::path& picture);
/// Opens an image file of any known format. Throws FileError, also for PNGs and JPEGs without their end marker, since
/// JPEG readers invent the missing part.
std::unique_ptr<PictureReader> open_picture(const std::filesystem::path& path);
/// Whether PNGs and JPEGs have their end marker; true for other formats.
bool has_end_marker(std::string_view bytes);
/// Shortens an error message of a codec to one line without the path.
std::string picture_problem(const std::string& error, const std::filesystem::path& path);

/// Type of the module's exported function, which returns its codecs.
using PictureCodecsFactory = const PictureCodecs* (*)();
inline constexpr const char* picture_codecs_symbol = "rebake_picture_codecs";

}  // namespace rebake
