#include "render/image.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/images/picture_codecs.h"
#include "mesh_ops/formats/images/png_writer.h"

namespace rebake {

namespace {
constexpr int compression_level = 6;  // zlib's default
}  // namespace

Image read_image(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) throw FileError(path, "does not exist");
  if (!std::filesystem::is_regular_file(path)) throw FileError(path, "is not a regular file");
  const auto reader = open_picture(path);
  const PictureLayout& layout = reader->layout();
  if (layout.width > 32768 || layout.height > 32768) throw FileError(path, "is larger than 32768 pixels per side");
  const int channels = layout.channels;
  std::vector<std::uint8_t> raw(static_cast<std::size_t>(layout.width) * static_cast<std::size_t>(layout.height) *
                                static_cast<std::size_t>(channels));
  Image image{layout.width, layout.height, {}};
  if (!reader->read(0, layout.height, channels, raw.data()))
    throw FileError(path, "cannot be decoded, it may be truncated: " + picture_problem(reader->error(), path));
  image.rgb.reserve(raw.size());
  for (std::size_t p = 0; p < raw.size(); p += static_cast<std::size_t>(channels))
    for (std::size_t c = 0; c < 3; ++c) image.rgb.push_back(raw[p + (channels >= 3 ? c : 0)]);
  return image;
}

void check_png_path(const std::filesystem::path& path, const SourceGuard& guard) {
  static constexpr std::array other_formats{".jpg", ".jpeg", ".webp", ".gif", ".bmp",  ".tif",  ".tiff", ".exr",
                                            ".hdr", ".tga",  ".ppm",  ".jxl", ".avif", ".heic", ".svg",  ".pdf"};
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (std::find(other_formats.begin(), other_formats.end(), extension) != other_formats.end())
    throw FileError(path, "pictures are written as PNG; name a .png file");
  guard.check_file(path);
}

void write_png(const Image& image, const std::filesystem::path& path, const SourceGuard& guard) {
  check_png_path(path, guard);
  write_file_atomically(path, encode_png(image.width, image.height, 3, image.rgb, compression_level), guard);
}

}  // namespace rebake
