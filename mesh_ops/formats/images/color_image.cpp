#include "mesh_ops/formats/images/color_image.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/images/picture_codecs.h"
#include "mesh_ops/formats/images/rgba_png.h"

namespace rebake {

namespace {

void check_size(int width, int height, const std::filesystem::path& name) {
  if (width < 1 || height < 1 || width > largest_png_side || height > largest_png_side)
    throw FileError(name, fmt::format("is {}×{}; at most {}² pixels are possible", width, height, largest_png_side));
}

// Spreads pixels of fewer channels to RGBA.
void spread(const std::uint8_t* from, int channels, std::size_t pixels, std::uint8_t* rgba) {
  const bool grey = channels < 3, alpha = channels == 2 || channels == 4;
  for (std::size_t k = 0; k < pixels; ++k, from += channels, rgba += 4) {
    for (int c = 0; c < 3; ++c) rgba[c] = from[grey ? 0 : c];
    rgba[3] = alpha ? from[channels - 1] : 255;
  }
}

}  // namespace

ColorImage decode_color_image(std::string_view bytes, const std::filesystem::path& name) {
  const PictureCodecs& codecs = picture_codecs(name);
  std::string problem;
  if (bytes.starts_with("RIFF")) {
    WebpImage webp;
    if (!codecs.decode_webp(bytes, webp, problem)) throw FileError(name, "cannot be read: " + problem);
    check_size(webp.width, webp.height, name);
    return {webp.width, webp.height, std::move(webp.rgba)};
  }
  const bool png = bytes.starts_with("\x89PNG"), jpeg = bytes.starts_with("\xff\xd8\xff");
  if (!png && !jpeg) throw FileError(name, "is neither PNG nor JPEG nor WebP");
  if (!has_end_marker(bytes)) throw FileError(name, "is truncated: its end marker is missing; copy it again");
  const auto reader = codecs.open_memory(png ? "png" : "jpeg", bytes, name.string(), problem);
  if (!reader) throw FileError(name, "cannot be read: " + picture_problem(problem, name));
  const PictureLayout& layout = reader->layout();
  check_size(layout.width, layout.height, name);
  const int channels = std::min(layout.channels, 4);
  const std::size_t row = static_cast<std::size_t>(layout.width);
  ColorImage image{layout.width, layout.height, {}};
  image.rgba.resize(4 * row * static_cast<std::size_t>(layout.height));
  constexpr int at_once = 256;
  std::vector<std::uint8_t> rows;
  for (int y = 0; y < layout.height; y += at_once) {
    const int count = std::min(at_once, layout.height - y);
    rows.resize(row * static_cast<std::size_t>(count) * static_cast<std::size_t>(channels));
    if (!reader->read(y, count, channels, rows.data()))
      throw FileError(name, "is damaged: " + picture_problem(reader->error(), name));
    spread(rows.data(), channels, row * static_cast<std::size_t>(count),
           &image.rgba[4 * row * static_cast<std::size_t>(y)]);
  }
  return image;
}

}  // namespace rebake
