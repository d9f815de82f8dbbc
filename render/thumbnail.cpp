#include "render/thumbnail.h"

#include <algorithm>
#include <utility>

namespace rebake {

Image thumbnail_of(const Image& image, int width, int height) {
  // Image pixels per thumbnail pixel: the largest crop with that aspect ratio, never less than 1.
  const double step =
      std::max(1.0, std::min(static_cast<double>(image.width) / width, static_cast<double>(image.height) / height));
  Image small;
  small.width = std::min(width, static_cast<int>(image.width / step));
  small.height = std::min(height, static_cast<int>(image.height / step));
  const double left = (image.width - small.width * step) / 2, top = (image.height - small.height * step) / 2;
  const auto range = [&](double from, int size) {
    const int first = std::clamp(static_cast<int>(from), 0, size - 1);
    return std::pair(first, std::clamp(static_cast<int>(from + step), first + 1, size));
  };
  for (int y = 0; y < small.height; ++y)
    for (int x = 0; x < small.width; ++x) {
      const auto [y0, y1] = range(top + y * step, image.height);
      const auto [x0, x1] = range(left + x * step, image.width);
      for (int c = 0; c < 3; ++c) {
        int sum = 0;
        for (int row = y0; row < y1; ++row)
          for (int column = x0; column < x1; ++column)
            sum += image.rgb[(static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                              static_cast<std::size_t>(column)) *
                                 3 +
                             static_cast<std::size_t>(c)];
        const int count = (y1 - y0) * (x1 - x0);
        small.rgb.push_back(static_cast<std::uint8_t>((sum + count / 2) / count));
      }
    }
  return small;
}

}  // namespace rebake
