#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

// Pictures as others write them, by OpenImageIO. With it come 250 libraries, which take 0.3 s to load where the rest of
// the program takes 0.02: so it lives in a module, loaded when the first such picture is read.

namespace rebake {

/// What a picture's file says of its pixels.
struct PictureLayout {
  int width = 0, height = 0, channels = 0;
  /// Of the picture that these pixels are a part of.
  int whole_width = 0, whole_height = 0;
  bool part = false;
  bool floating = false;    ///< channels are floating-point numbers
  std::string type;         ///< of a channel, such as "uint8"
  std::string color_space;  ///< as the file or its format says; may be empty
  int rows_at_once = 1;     ///< whose multiples may be read: the height of a tile
};

/// Reads rows of a picture.
class PictureReader {
 public:
  explicit PictureReader(PictureLayout layout) : layout_(std::move(layout)) {}
  virtual ~PictureReader() = default;
  PictureReader(const PictureReader&) = delete;
  PictureReader& operator=(const PictureReader&) = delete;

  const PictureLayout& layout() const { return layout_; }

  /// The first `channels` channels of `count` rows from `first` on, whole numbers as 0…255 or as 0…1. False where the
  /// file is damaged.
  virtual bool read(int first, int count, int channels, std::uint8_t* to) = 0;
  virtual bool read(int first, int count, int channels, float* to) = 0;
  /// What was wrong.
  virtual std::string error() const = 0;

 private:
  PictureLayout layout_;
};

/// What the module gives. Where a picture cannot be opened, null, and `error` says why.
class PictureCodecs {
 public:
  virtual ~PictureCodecs() = default;
  PictureCodecs(const PictureCodecs&) = delete;
  PictureCodecs& operator=(const PictureCodecs&) = delete;

  /// Colours are not multiplied by alpha where the format does not store them so.
  virtual std::unique_ptr<PictureReader> open(const std::filesystem::path& path, std::string& error) const = 0;
  /// A PNG's bytes, which have to stay. `name` is for messages.
  virtual std::unique_ptr<PictureReader> open_png(std::string_view bytes, const std::string& name,
                                                  std::string& error) const = 0;

 protected:
  PictureCodecs() = default;
};

/// Loads the module, to read a picture. Throws FileError, of that picture, where the module is not there.
const PictureCodecs& picture_codecs(const std::filesystem::path& picture);
/// Opens a picture of any format. Throws FileError, also for PNGs and JPEGs that end before their end is marked: JPEG
/// readers make up what is missing.
std::unique_ptr<PictureReader> open_picture(const std::filesystem::path& path);
/// What codecs say of a file, on one line, without its path.
std::string picture_problem(const std::string& error, const std::filesystem::path& path);

/// The module's function that gives them.
using GivePictureCodecs = const PictureCodecs* (*)();
inline constexpr const char* picture_codecs_symbol = "rebake_picture_codecs";

}  // namespace rebake
