#include "render/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

using Plane = std::vector<double>;

Plane luma(const Image& image) {
  Plane out(image.rgb.size() / 3);
  for (std::size_t p = 0; p < out.size(); ++p)
    out[p] = 0.299 * image.rgb[p * 3] + 0.587 * image.rgb[p * 3 + 1] + 0.114 * image.rgb[p * 3 + 2];
  return out;
}

// Separable Gaussian filter, σ 1.5, 11 taps; border pixels are repeated.
Plane blurred(const Plane& in, int width, int height) {
  std::array<double, 11> kernel{};
  double sum = 0;
  for (int k = 0; k < 11; ++k) sum += kernel[static_cast<std::size_t>(k)] = std::exp(-(k - 5) * (k - 5) / 4.5);
  const auto pass = [&](const Plane& source, bool across) {
    Plane out(source.size());
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        double value = 0;
        for (int k = -5; k <= 5; ++k) {
          const int sx = across ? std::clamp(x + k, 0, width - 1) : x,
                    sy = across ? y : std::clamp(y + k, 0, height - 1);
          value +=
              kernel[static_cast<std::size_t>(k + 5)] / sum *
              source[static_cast<std::size_t>(sy) * static_cast<std::size_t>(width) + static_cast<std::size_t>(sx)];
        }
        out[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] = value;
      }
    return out;
  };
  return pass(pass(in, true), false);
}

Plane product(const Plane& a, const Plane& b) {
  Plane out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = a[i] * b[i];
  return out;
}

}  // namespace

std::vector<double> ssim_map(const Image& a, const Image& b) {
  const Plane x = luma(a), y = luma(b);
  const auto blur = [&](const Plane& p) { return blurred(p, a.width, a.height); };
  const Plane mx = blur(x), my = blur(y), xx = blur(product(x, x)), yy = blur(product(y, y)), xy = blur(product(x, y));
  constexpr double c1 = 0.01 * 255 * 0.01 * 255, c2 = 0.03 * 255 * 0.03 * 255;
  std::vector<double> map;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double vx = xx[i] - mx[i] * mx[i], vy = yy[i] - my[i] * my[i], cov = xy[i] - mx[i] * my[i];
    map.push_back((2 * mx[i] * my[i] + c1) * (2 * cov + c2) / ((mx[i] * mx[i] + my[i] * my[i] + c1) * (vx + vy + c2)));
  }
  return map;
}

Difference compare(const Image& a, const Image& b, int tolerance) {
  if (a.width != b.width || a.height != b.height)
    throw Error(fmt::format("the pictures differ in size: {}×{} and {}×{}", a.width, a.height, b.width, b.height));
  Difference result;
  double squares = 0;
  std::size_t beyond = 0;
  for (std::size_t p = 0; p < a.rgb.size(); p += 3) {
    int worst = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const int d = std::abs(int{a.rgb[p + c]} - int{b.rgb[p + c]});
      squares += d * d;
      worst = std::max(worst, d);
    }
    if (worst > result.largest) {
      result.largest = worst;
      result.x = static_cast<int>(p / 3 % static_cast<std::size_t>(a.width));
      result.y = static_cast<int>(p / 3 / static_cast<std::size_t>(a.width));
    }
    beyond += worst > tolerance ? 1 : 0;
  }
  const double pixels = static_cast<double>(a.rgb.size()) / 3;
  result.share_beyond = static_cast<double>(beyond) / pixels;
  result.psnr_db =
      squares == 0 ? std::numeric_limits<double>::infinity() : 10 * std::log10(255.0 * 255.0 * pixels * 3 / squares);
  if (squares > 0) {
    const std::vector<double> map = ssim_map(a, b);
    result.ssim = std::accumulate(map.begin(), map.end(), 0.0) / static_cast<double>(map.size());
  }
  return result;
}

}  // namespace rebake
