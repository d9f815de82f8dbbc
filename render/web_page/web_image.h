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
enum class WebImageCoding { smaller, png, webp };

/// Encodes RGBA bytes, row by row, as PNG or lossless WebP; by default as the smaller one. Colours under an alpha of 0
/// are kept. Images that are too large for WebP become PNGs.
WebImage web_image(int width, int height, const std::vector<std::uint8_t>& rgba,
                   WebImageCoding coding = WebImageCoding::smaller);

}  // namespace rebake
