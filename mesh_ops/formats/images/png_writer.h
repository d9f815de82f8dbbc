#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace rebake {

/// Encodes a PNG with 8 bits per channel, RGB or RGBA, incrementally by rows. Writes no colour-space chunks, since
/// browsers would convert pixels by them.
class PngEncoder {
 public:
  /// Receives the next bytes of the file. Its exceptions pass through the encoder.
  using Sink = std::function<void(std::string_view bytes)>;

  /// `channels`: 3 (RGB) or 4 (RGBA). `compression`: zlib level, 1 … 9. Throws std::invalid_argument for other channels
  /// or an empty image, and std::bad_alloc.
  PngEncoder(int width, int height, int channels, int compression, Sink sink);
  ~PngEncoder();
  PngEncoder(const PngEncoder&) = delete;
  PngEncoder& operator=(const PngEncoder&) = delete;

  /// Encodes the next rows, from the top: a whole number of rows of width × channels bytes. Throws
  /// std::invalid_argument for other sizes.
  void write_rows(std::span<const std::uint8_t> pixels);
  /// Completes the file. Call it after the last row.
  void finish();

  struct State;

 private:
  std::unique_ptr<State> state_;
};

/// Encodes a whole PNG. Throws like PngEncoder.
std::string encode_png(int width, int height, int channels, std::span<const std::uint8_t> pixels, int compression);

}  // namespace rebake
