#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace rebake {

/// A PNG of 8 bits a channel: 3 channels (RGB, row after row from the top) or 4 (RGBA). No colour chunks, since
/// browsers would alter bytes by them. `compression` is zlib's level, 1 to 9. Throws std::bad_alloc.
std::string encode_png(int width, int height, int channels, std::span<const std::uint8_t> pixels, int compression);

}  // namespace rebake
