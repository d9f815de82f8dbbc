#include "render/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fstream>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/images/picture_codecs.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "mesh_ops/scene/scene_light.h"
#include "render/picture_mark.h"

namespace rebake {

namespace {

constexpr int compression_level = 6;  // zlib's default

// Formats that the module of OpenImageIO writes. PNGs are encoded here: loading the module takes 0.2 s, which is three
// times as long as a small picture.
struct WrittenFormat {
  std::string_view extension;
  const char* name;   // in OpenImageIO
  bool linear_light;  // half floats
};
constexpr std::array written_formats{WrittenFormat{".jpg", "jpeg", false}, WrittenFormat{".jpeg", "jpeg", false},
                                     WrittenFormat{".webp", "webp", false}, WrittenFormat{".exr", "openexr", true}};

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

// The first bytes of a file; fewer if it is shorter.
std::string beginning_of(const std::filesystem::path& path) {
  std::string bytes(64, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

// Whether bytes begin as those of a picture format that readers know.
bool begins_as_picture(std::string_view bytes) {
  using namespace std::string_view_literals;
  constexpr std::array marks{"\x89PNG"sv, "\xff\xd8\xff"sv, "\x76\x2f\x31\x01"sv, "II*\0"sv, "MM\0*"sv, "#?"sv};
  return std::any_of(marks.begin(), marks.end(), [&](std::string_view mark) { return bytes.starts_with(mark); }) ||
         (bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP"));
}

// Interleaved channels of a picture: RGB, or RGBA.
std::vector<std::uint8_t> pixels_of(const Image& image) {
  if (image.alpha.empty()) return image.rgb;
  std::vector<std::uint8_t> pixels;
  pixels.reserve(4 * image.alpha.size());
  for (std::size_t p = 0; p < image.alpha.size(); ++p) {
    pixels.insert(pixels.end(), &image.rgb[3 * p], &image.rgb[3 * p] + 3);
    pixels.push_back(image.alpha[p]);
  }
  return pixels;
}

// The bytes of a picture file. Throws FileError.
std::string encoded(const Image& image, const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  const auto format = std::find_if(written_formats.begin(), written_formats.end(),
                                   [&](const WrittenFormat& one) { return one.extension == extension; });
  const bool has_alpha = !image.alpha.empty() && holds_alpha(path);
  if (format == written_formats.end())
    return with_mark(encode_png(image.width, image.height, has_alpha ? 4 : 3, pixels_of(image), compression_level),
                     image.width, image.height, has_alpha);
  const PictureCodecs& codecs = picture_codecs(path);
  std::string bytes, error;
  bool done = false;
  if (format->linear_light) {
    std::array<float, 256> light{};
    for (std::size_t k = 0; k < light.size(); ++k)
      light[k] = static_cast<float>(to_linear(static_cast<double>(k) / 255));
    std::vector<FloatChannel> channels{{"R", true}, {"G", true}, {"B", true}};
    if (!image.alpha.empty()) channels.push_back({"A", true});
    std::vector<float> pixels;
    pixels.reserve(image.rgb.size() / 3 * channels.size());
    for (std::size_t p = 0; p < image.rgb.size() / 3; ++p) {
      const float alpha = image.alpha.empty() ? 1 : static_cast<float>(image.alpha[p]) / 255;
      for (std::size_t c = 0; c < 3; ++c) pixels.push_back(light[image.rgb[3 * p + c]] * alpha);
      if (!image.alpha.empty()) pixels.push_back(alpha);
    }
    done = codecs.encode_exr(image.width, image.height, channels, {openexr_mark}, pixels.data(), bytes, error);
  } else {
    const std::vector<std::uint8_t> pixels = has_alpha ? pixels_of(image) : image.rgb;
    done = codecs.encode(format->name, image.width, image.height, has_alpha ? 4 : 3, pixels.data(), bytes, error);
  }
  if (!done) throw FileError(path, "cannot be encoded: " + picture_problem(error, path));
  return with_mark(bytes, image.width, image.height, has_alpha);
}

}  // namespace

Image read_image(const std::filesystem::path& path, AlphaChannel alpha) {
  if (!std::filesystem::exists(path)) throw FileError(path, "does not exist");
  if (!std::filesystem::is_regular_file(path)) throw FileError(path, "is not a regular file");
  const auto reader = open_picture(path);
  const PictureLayout& layout = reader->layout();
  if (layout.width > 32768 || layout.height > 32768) throw FileError(path, "is larger than 32768 pixels per side");
  const int channels = layout.channels;
  const std::size_t pixels = static_cast<std::size_t>(layout.width) * static_cast<std::size_t>(layout.height);
  if (layout.floating && path.extension() == ".exr") {
    // Linear light, as write_picture() writes it.
    std::vector<float> light(pixels * static_cast<std::size_t>(channels));
    if (!reader->read(0, layout.height, channels, light.data()))
      throw FileError(path, "cannot be decoded, it may be truncated: " + picture_problem(reader->error(), path));
    Image picture{layout.width, layout.height, {}, {}};
    for (std::size_t p = 0; p < pixels; ++p)
      for (std::size_t c = 0; c < 3; ++c) {
        const double value = light[p * static_cast<std::size_t>(channels) + (channels >= 3 ? c : 0)];
        const double shown = std::isfinite(value) ? to_display(std::clamp(value, 0.0, 1.0)) : 0;
        picture.rgb.push_back(static_cast<std::uint8_t>(std::lround(255 * shown)));
      }
    return picture;
  }
  std::vector<std::uint8_t> raw(static_cast<std::size_t>(layout.width) * static_cast<std::size_t>(layout.height) *
                                static_cast<std::size_t>(channels));
  Image image{layout.width, layout.height, {}, {}};
  if (!reader->read(0, layout.height, channels, raw.data()))
    throw FileError(path, "cannot be decoded, it may be truncated: " + picture_problem(reader->error(), path));
  image.rgb.reserve(raw.size());
  for (std::size_t p = 0; p < raw.size(); p += static_cast<std::size_t>(channels))
    for (std::size_t c = 0; c < 3; ++c) image.rgb.push_back(raw[p + (channels >= 3 ? c : 0)]);
  if (const bool has_alpha = channels == 2 || channels == 4; has_alpha && alpha == AlphaChannel::keep)
    for (auto p = static_cast<std::size_t>(channels) - 1; p < raw.size(); p += static_cast<std::size_t>(channels))
      image.alpha.push_back(raw[p]);
  return image;
}

bool holds_alpha(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  return extension != ".jpg" && extension != ".jpeg";
}

std::string picture_extensions() {
  std::string all = ".png";
  for (const WrittenFormat& format : written_formats) all += fmt::format(", {}", format.extension);
  return all;
}

void check_picture_path(const std::filesystem::path& path, const SourceGuard& guard) {
  static constexpr std::array unsupported{".tif", ".tiff", ".gif",  ".bmp",  ".hdr", ".tga",
                                          ".ppm", ".jxl",  ".avif", ".heic", ".svg", ".pdf"};
  if (std::find(unsupported.begin(), unsupported.end(), extension_of(path)) != unsupported.end())
    throw FileError(path, "pictures are not written in this format; name a file that ends in " + picture_extensions());
  guard.check_file(path);
  if (std::error_code error; std::filesystem::is_regular_file(path, error) &&
                             std::filesystem::file_size(path, error) > 0 && !begins_as_picture(beginning_of(path)))
    throw FileError(path, "exists and is not a picture, so it is not replaced; choose another name");
}

bool is_picture_file(const std::filesystem::path& path) { return begins_as_picture(beginning_of(path)); }

bool is_rendered_picture(const std::filesystem::path& path) { return has_mark(path); }

void write_picture(const Image& image, const std::filesystem::path& path, const SourceGuard& guard) {
  check_picture_path(path, guard);
  write_file_atomically(path, encoded(image, path), guard);
}

}  // namespace rebake
