#include "mesh_ops/formats/images/picture_codecs.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/module.h"

namespace rebake {

namespace {

constexpr std::string_view formats = "OpenEXR, Radiance HDR, PNG, JPEG, TIFF or WebP";

bool known_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array<std::string_view, 8> known{".exr", ".hdr", ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".webp"};
  return std::find(known.begin(), known.end(), extension) != known.end();
}

}  // namespace

bool has_end_marker(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) {
    // PNG chunks: length, name, data, checksum.
    for (std::size_t at = 8; at + 12 <= bytes.size();) {
      if (bytes.substr(at + 4, 4) == "IEND") return true;
      std::size_t length = 0;
      for (std::size_t k = 0; k < 4; ++k) length = length << 8 | static_cast<unsigned char>(bytes[at + k]);
      at += 12 + length;
    }
    return false;
  }
  if (bytes.starts_with("\xff\xd8\xff")) {
    // JPEG segments up to the first scan state their length, which includes thumbnails in them. Scans contain no
    // markers of other images.
    const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(bytes[at]); };
    for (std::size_t at = 2; at + 4 <= bytes.size() && byte(at) == 0xff;) {
      if (byte(at + 1) == 0xda) return bytes.find("\xff\xd9", at) != std::string_view::npos;
      // Bytes of 255 may pad the space before a marker.
      at += byte(at + 1) == 0xff ? 1U : 2U + (byte(at + 2) << 8U | byte(at + 3));
    }
    return false;
  }
  return true;
}

const PictureCodecs& picture_codecs(const std::filesystem::path& picture) {
  static const ModuleSymbol found = module_symbol("librebake_pictures.so", picture_codecs_symbol);
  if (found.symbol == nullptr)
    throw FileError(picture, found.problem.empty()
                                 ? "needs librebake_pictures.so, which is neither beside Rebake nor in lib/rebake; "
                                   "build or install Rebake again"
                                 : "needs OpenImageIO: " + found.problem);
  static const PictureCodecs* const codecs = reinterpret_cast<PictureCodecsFactory>(found.symbol)();
  return *codecs;
}

std::string picture_problem(const std::string& error, const std::filesystem::path& path) {
  std::string text = error.substr(0, error.find('\n'));
  // Text before the path repeats the rest of the message, if there is a rest.
  const std::string quoted = '"' + path.string() + '"';
  if (const std::size_t at = text.find(quoted); at != std::string::npos) {
    const bool rest = text.find_first_not_of(" .)", at + quoted.size()) != std::string::npos;
    text.erase(rest ? 0 : at, rest ? at + quoted.size() : std::string::npos);
  }
  const auto left_out = [](char c) { return c == '.' || c == ' ' || c == '('; };
  while (!text.empty() && left_out(text.front())) text.erase(text.begin());
  while (!text.empty() && left_out(text.back())) text.pop_back();
  return text.empty() ? "its format is unknown" : text;
}

std::unique_ptr<PictureReader> open_picture(const std::filesystem::path& path) {
  const PictureCodecs& codecs = picture_codecs(path);
  if (!has_end_marker(read_file(path))) throw FileError(path, "is truncated: its end marker is missing; copy it again");
  std::string error;
  std::unique_ptr<PictureReader> reader = codecs.open(path, error);
  if (reader) return reader;
  if (!known_extension(path))
    throw FileError(path, std::string("is not in a supported image format; use ").append(formats));
  throw FileError(path, "cannot be read as an image: " + picture_problem(error, path));
}

}  // namespace rebake
