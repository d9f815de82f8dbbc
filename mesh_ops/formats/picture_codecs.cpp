#include "mesh_ops/formats/picture_codecs.h"

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

// Where a format marks its end, whether that is there.
bool has_its_end(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) {
    // Chunks: length, name, data, checksum.
    for (std::size_t at = 8; at + 12 <= bytes.size();) {
      if (bytes.substr(at + 4, 4) == "IEND") return true;
      std::size_t length = 0;
      for (std::size_t k = 0; k < 4; ++k) length = length << 8 | static_cast<unsigned char>(bytes[at + k]);
      at += 12 + length;
    }
    return false;
  }
  if (bytes.starts_with("\xff\xd8\xff")) {
    // After the last scan's start; what embedded thumbnails hold comes before it.
    const std::size_t scan = bytes.rfind("\xff\xda"), end = bytes.rfind("\xff\xd9");
    return scan == std::string_view::npos || (end != std::string_view::npos && end > scan);
  }
  return true;
}

}  // namespace

const PictureCodecs& picture_codecs(const std::filesystem::path& picture) {
  static const ModuleSymbol found = module_symbol("librebake_pictures.so", picture_codecs_symbol);
  if (found.symbol == nullptr)
    throw FileError(picture,
                    "cannot be read: " + (found.problem.empty()
                                              ? "librebake_pictures.so, which reads such pictures, lies neither beside "
                                                "Rebake nor in lib/rebake; build or install Rebake again"
                                              : found.problem));
  static const PictureCodecs* const codecs = reinterpret_cast<GivePictureCodecs>(found.symbol)();
  return *codecs;
}

std::string picture_problem(const std::string& error, const std::filesystem::path& path) {
  std::string text = error.substr(0, error.find('\n'));
  // What comes before the path says what the rest of the message does.
  const std::string quoted = '"' + path.string() + '"';
  if (const std::size_t at = text.find(quoted); at != std::string::npos) text.erase(0, at + quoted.size());
  const auto left_out = [](char c) { return c == '.' || c == ' '; };
  while (!text.empty() && left_out(text.front())) text.erase(text.begin());
  while (!text.empty() && left_out(text.back())) text.pop_back();
  return text.empty() ? "its format is not known" : text;
}

std::unique_ptr<PictureReader> open_picture(const std::filesystem::path& path) {
  const PictureCodecs& codecs = picture_codecs(path);
  if (!has_its_end(read_file(path))) throw FileError(path, "is truncated: it ends before its picture does");
  std::string error;
  std::unique_ptr<PictureReader> reader = codecs.open(path, error);
  if (reader) return reader;
  std::string message = "cannot be read as a picture: " + picture_problem(error, path);
  if (!known_extension(path)) message.append("; use ").append(formats);
  throw FileError(path, message);
}

}  // namespace rebake
