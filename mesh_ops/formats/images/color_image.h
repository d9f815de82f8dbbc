#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace rebake {

/// An image with 8 bits per channel, RGBA, row 0 at the top.
struct ColorImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba{};
  const std::uint8_t* pixel(int x, int y) const {
    return &rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x))];
  }
};

/// Decodes a PNG, JPEG or WebP of at most 16384² pixels. Grey becomes R = G = B, a missing alpha 255, and 16 bits are
/// rounded to 8; no colour space is converted. `name` is for messages. Throws FileError.
ColorImage decode_color_image(std::string_view bytes, const std::filesystem::path& name);

}  // namespace rebake
