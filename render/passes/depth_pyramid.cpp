#include "render/passes/depth_pyramid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rebake {

void DepthPyramid::build(const SampleRect& rect, const std::vector<float>& nearness) {
  rect_ = rect;
  nearness_ = &nearness;
  const int width = rect.right - rect.left, height = rect.top - rect.bottom;
  std::size_t depth = 0;
  const auto level = [&](int w, int h) -> Level& {
    if (levels_.size() == depth) levels_.emplace_back();
    Level& made = levels_[depth++];
    made.width = w;
    made.height = h;
    made.farthest.assign(static_cast<std::size_t>(w) * static_cast<std::size_t>(h),
                         std::numeric_limits<float>::infinity());
    return made;
  };
  Level& finest = level((width + block - 1) / block, (height + block - 1) / block);
  tbb::parallel_for(0, finest.height, [&](int row) {
    float* out = &finest.farthest[static_cast<std::size_t>(row) * static_cast<std::size_t>(finest.width)];
    for (int y = row * block; y < std::min(height, (row + 1) * block); ++y) {
      const float* in = &nearness[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)];
      const int whole = width / block;
      for (int x = 0; x < whole; ++x)
        out[x] = std::min(out[x], std::min(std::min(in[x * block], in[x * block + 1]),
                                           std::min(in[x * block + 2], in[x * block + 3])));
      for (int x = whole * block; x < width; ++x) out[whole] = std::min(out[whole], in[x]);
    }
  });
  while (levels_[depth - 1].width > 1 || levels_[depth - 1].height > 1) {
    const int w = (levels_[depth - 1].width + 1) / 2, h = (levels_[depth - 1].height + 1) / 2;
    Level& coarser = level(w, h);
    const Level& finer = levels_[depth - 2];
    for (int y = 0; y < finer.height; ++y)
      for (int x = 0; x < finer.width; ++x) {
        float& out = coarser.farthest[static_cast<std::size_t>(y / 2) * static_cast<std::size_t>(w) +
                                      static_cast<std::size_t>(x / 2)];
        out = std::min(out, finer.farthest[static_cast<std::size_t>(y) * static_cast<std::size_t>(finer.width) +
                                           static_cast<std::size_t>(x)]);
      }
  }
  levels_.resize(depth);
}

bool DepthPyramid::hides(const ScreenTriangle& t) const {
  const int left = std::max(t.samples.left - rect_.left, 0), bottom = std::max(t.samples.bottom - rect_.bottom, 0),
            right = std::min(t.samples.right, rect_.right - 1) - rect_.left,
            top = std::min(t.samples.top, rect_.top - 1) - rect_.bottom;
  constexpr int max_blocks = 1024;
  if ((right / block - left / block + 1) * (top / block - bottom / block + 1) > max_blocks) return false;
  // A linear function a · x + b · y + c at the centre of the sample in column x, row y of the rectangle.
  struct Linear {
    double a, b, c;
    double at(double x, double y) const { return a * x + b * y + c; }
    double most_of(double x, double y, double width, double height) const {
      return at(x, y) + std::max(0.0, a * width) + std::max(0.0, b * height);
    }
  };
  const double abx = t.x[1] - t.x[0], aby = t.y[1] - t.y[0], acx = t.x[2] - t.x[0], acy = t.y[2] - t.y[0];
  const double abn = t.nearness[1] - t.nearness[0], acn = t.nearness[2] - t.nearness[0];
  const double area = abx * acy - aby * acx;
  const double x_shift = rect_.left + 0.5, y_shift = rect_.bottom + 0.5;
  // Upper bound of nearness: the triangle's plane, raised by the displacement and error of the corners that a driver
  // interpolates.
  Linear plane{(abn * acy - acn * aby) / area, (acn * abx - abn * acx) / area, 0};
  plane.c = t.nearness[0] + plane.a * (x_shift - t.x[0]) + plane.b * (y_shift - t.y[0]) +
            (std::abs(plane.a) + std::abs(plane.b)) * t.moved + t.error;
  // Drivers compute slopes in floats; the error is large for slivers.
  constexpr double rounding = 16.0 / (1 << 24);
  const double longest =
      std::max({abx * abx + aby * aby, acx * acx + acy * acy, (acx - abx) * (acx - abx) + (acy - aby) * (acy - aby)});
  const auto [least, most] = std::minmax({t.nearness[0], t.nearness[1], t.nearness[2]});
  plane.c += rounding * (most - least) * longest / std::abs(area);
  if (!std::isfinite(plane.c)) return false;
  // Edge functions, not negative inside the triangle and within the displacement of its corners.
  std::array<Linear, 3> edges;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const double sign = area > 0 ? 1 : -1, ex = sign * (t.x[next] - t.x[k]), ey = sign * (t.y[next] - t.y[k]);
    edges[k] = {-ey, ex, ex * (y_shift - t.y[k]) - ey * (x_shift - t.x[k]) + t.moved * std::hypot(ex, ey)};
  }
  const int width = rect_.right - rect_.left;
  const Level& finest = levels_.front();
  for (int row = bottom / block; row <= top / block; ++row)
    for (int column = left / block; column <= right / block; ++column) {
      const int x0 = std::max(column * block, left), y0 = std::max(row * block, bottom),
                x1 = std::min(column * block + block - 1, right), y1 = std::min(row * block + block - 1, top);
      const auto most_of = [&](const Linear& f) { return f.most_of(x0, y0, x1 - x0, y1 - y0); };
      if (most_of(edges[0]) < 0 || most_of(edges[1]) < 0 || most_of(edges[2]) < 0) continue;
      const float farthest = finest.farthest[static_cast<std::size_t>(row) * static_cast<std::size_t>(finest.width) +
                                             static_cast<std::size_t>(column)];
      if (static_cast<double>(farthest) > most_of(plane)) continue;
      for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
          if (edges[0].at(x, y) < 0 || edges[1].at(x, y) < 0 || edges[2].at(x, y) < 0) continue;
          const float there =
              (*nearness_)[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
          if (!(static_cast<double>(there) > plane.at(x, y))) return false;
        }
    }
  return true;
}

bool DepthPyramid::hides(const SampleRect& samples, float nearness) const {
  if (samples.right < rect_.left || samples.top < rect_.bottom || samples.left >= rect_.right ||
      samples.bottom >= rect_.top)
    return true;
  unsigned left = static_cast<unsigned>(std::max(samples.left - rect_.left, 0)) / block,
           bottom = static_cast<unsigned>(std::max(samples.bottom - rect_.bottom, 0)) / block,
           right = static_cast<unsigned>(std::min(samples.right, rect_.right - 1) - rect_.left) / block,
           top = static_cast<unsigned>(std::min(samples.top, rect_.top - 1) - rect_.bottom) / block;
  // Selects the level where the rectangle spans at most 4×4 blocks.
  const Level* level = levels_.data();
  for (; right - left > 3 || top - bottom > 3; ++level) left /= 2, right /= 2, bottom /= 2, top /= 2;
  const float* row = &level->farthest[static_cast<std::size_t>(bottom) * static_cast<unsigned>(level->width)];
  for (unsigned y = bottom; y <= top; ++y, row += level->width)
    for (unsigned x = left; x <= right; ++x)
      // Not "<=", so that NaN neither occludes nor is occluded.
      if (!(row[x] > nearness)) return false;
  return true;
}

}  // namespace rebake
