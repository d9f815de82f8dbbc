#include "mesh_ops/formats/images/png_filters.h"

#include <algorithm>
#include <cstring>

namespace rebake {

namespace {

// Wavefront order: a pixel depends on its left, upper and upper-left neighbours, so each of four rows is processed one
// pixel behind the row above. A vector has the four channels of two rows.
using Lanes = std::int16_t __attribute__((vector_size(16)));
using Bytes = std::uint8_t __attribute__((vector_size(8)));

Lanes load(std::uint32_t first, std::uint32_t second) {
  const std::uint32_t both[2] = {first, second};
  Bytes bytes;
  std::memcpy(&bytes, both, sizeof bytes);
  return __builtin_convertvector(bytes, Lanes);
}

std::uint32_t pixel(const std::uint8_t* at) {
  std::uint32_t value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

Lanes magnitude(Lanes v) { return v < 0 ? -v : v; }

// Prediction modes of two rows, as lane masks.
struct Filters {
  Lanes sub{}, up{}, average{}, paeth{};

  void set(int row, std::uint8_t filter) {
    Lanes* const masks[] = {nullptr, &sub, &up, &average, &paeth};
    if (Lanes* const mask = filter < 5 ? masks[filter] : nullptr)
      for (int c = 0; c < 4; ++c) (*mask)[row * 4 + c] = -1;
  }

  // Adds the prediction to filtered bytes. `left`, `above` and `corner`: channels of the neighbouring pixels.
  Lanes undo(Lanes filtered, Lanes left, Lanes above, Lanes corner) const {
    const Lanes to_left = magnitude(above - corner), to_above = magnitude(left - corner),
                to_corner = magnitude(left + above - corner - corner);
    const Lanes nearest =
        ((to_left <= to_above) & (to_left <= to_corner)) ? left : (to_above <= to_corner ? above : corner);
    const Lanes predicted = (left & sub) | (above & up) | (((left + above) >> 1) & average) | (nearest & paeth);
    return (filtered + predicted) & 255;
  }
};

struct Wave {
  Filters first, second;  // filters of rows 0 and 1, and of rows 2 and 3
  Lanes left[2]{}, above[2]{};

  // Processes the next pixel of row 0 (below `upper`), the pixel before it in row 1, and so on.
  void step(const std::uint32_t filtered[4], std::uint32_t upper) {
    const Lanes corner[2] = {above[0], above[1]};
    const Lanes top = load(upper, 0);
    above[0] = __builtin_shufflevector(top, left[0], 0, 1, 2, 3, 8, 9, 10, 11);
    above[1] = __builtin_shufflevector(left[0], left[1], 4, 5, 6, 7, 8, 9, 10, 11);
    left[0] = first.undo(load(filtered[0], filtered[1]), left[0], above[0], corner[0]);
    left[1] = second.undo(load(filtered[2], filtered[3]), left[1], above[1], corner[1]);
  }
  void store(std::uint32_t pixels[4]) const {
    const Bytes bytes[2] = {__builtin_convertvector(left[0], Bytes), __builtin_convertvector(left[1], Bytes)};
    std::memcpy(pixels, bytes, sizeof bytes);
  }
};

}  // namespace

void undo_png_filters(std::uint8_t* rows, int count, int width, const std::uint8_t* above) {
  const std::size_t stride = 1 + 4 * static_cast<std::size_t>(width);
  for (int y = 0; y < count; y += png_filter_rows) {
    Wave wave;
    std::uint8_t* row[png_filter_rows];
    for (int r = 0; r < png_filter_rows; ++r) {
      std::uint8_t* const begin = rows + static_cast<std::size_t>(y + r) * stride;
      if (y + r < count) (r < 2 ? wave.first : wave.second).set(r % 2, *begin);
      row[r] = begin + 1;
    }
    const auto edge = [&](int t) {
      std::uint32_t filtered[4]{}, done[4];
      for (int r = 0; r < png_filter_rows; ++r)
        if (t >= r && t - r < width) filtered[r] = pixel(row[r] + 4 * (t - r));
      wave.step(filtered, t < width ? pixel(above + 4 * t) : 0);
      wave.store(done);
      for (int r = 0; r < png_filter_rows; ++r)
        if (t >= r && t - r < width) std::memcpy(row[r] + 4 * (t - r), &done[r], 4);
    };
    const int ramp = png_filter_rows - 1;
    int t = 0;
    for (; t < std::min(ramp, width); ++t) edge(t);
    for (; t < width; ++t) {
      const std::uint8_t* const at = row[0] + 4 * t;
      const std::uint32_t filtered[4] = {pixel(at), pixel(row[1] + 4 * (t - 1)), pixel(row[2] + 4 * (t - 2)),
                                         pixel(row[3] + 4 * (t - 3))};
      std::uint32_t done[4];
      wave.step(filtered, pixel(above + 4 * t));
      wave.store(done);
      for (int r = 0; r < png_filter_rows; ++r) std::memcpy(row[r] + 4 * (t - r), &done[r], 4);
    }
    for (; t < width + ramp; ++t) edge(t);
    above = row[png_filter_rows - 1];
  }
}

int first_unknown_png_filter(const std::uint8_t* rows, int count, std::size_t stride) {
  int y = 0;
  while (y < count && rows[static_cast<std::size_t>(y) * stride] <= 4) ++y;
  return y;
}

}  // namespace rebake
