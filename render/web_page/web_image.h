#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rebake {

/// A lossless image for browsers.
struct WebImage {
  std::string bytes;
  const char* extension;  ///< "png" or "webp"
};
/// Encodes RGBA bytes, row by row, as PNG or lossless WebP, whichever is smaller. Colours under an alpha of 0 are kept.
WebImage web_image(int width, int height, const std::vector<std::uint8_t>& rgba);

}  // namespace rebake
