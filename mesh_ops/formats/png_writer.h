#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace rebake {

/// Encodes a PNG of 8 bits a channel, some rows at a time: 3 channels (RGB) or 4 (RGBA). No colour chunks, since
/// browsers would alter bytes by them.
class PngEncoder {
 public:
  /// Takes the next bytes of the file. What it throws passes through.
  using Sink = std::function<void(std::string_view bytes)>;

  /// `compression` is zlib's level, 1 to 9. Throws std::bad_alloc.
  PngEncoder(int width, int height, int channels, int compression, Sink sink);
  ~PngEncoder();
  PngEncoder(const PngEncoder&) = delete;
  PngEncoder& operator=(const PngEncoder&) = delete;

  /// The next rows, from the top: a whole number of them, width × channels bytes each.
  void write_rows(std::span<const std::uint8_t> pixels);
  /// To be called after the last row.
  void finish();

  struct State;

 private:
  std::unique_ptr<State> state_;
};

/// A whole PNG. Throws std::bad_alloc.
std::string encode_png(int width, int height, int channels, std::span<const std::uint8_t> pixels, int compression);

}  // namespace rebake
