#include "render/passes/depth_pyramid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

namespace rebake {

void DepthPyramid::build(const SampleRect& rect, const std::vector<float>& nearness) {
  rect_ = rect;
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

bool DepthPyramid::hides(const SampleRect& samples, float nearness) const {
  if (samples.right < rect_.left || samples.top < rect_.bottom || samples.left >= rect_.right ||
      samples.bottom >= rect_.top)
    return true;
  unsigned left = static_cast<unsigned>(std::max(samples.left - rect_.left, 0)) / block,
           bottom = static_cast<unsigned>(std::max(samples.bottom - rect_.bottom, 0)) / block,
           right = static_cast<unsigned>(std::min(samples.right, rect_.right - 1) - rect_.left) / block,
           top = static_cast<unsigned>(std::min(samples.top, rect_.top - 1) - rect_.bottom) / block;
  // At most 4 × 4 blocks are looked at.
  const Level* level = levels_.data();
  for (; right - left > 3 || top - bottom > 3; ++level) left /= 2, right /= 2, bottom /= 2, top /= 2;
  const float* row = &level->farthest[static_cast<std::size_t>(bottom) * static_cast<unsigned>(level->width)];
  for (unsigned y = bottom; y <= top; ++y, row += level->width)
    for (unsigned x = left; x <= right; ++x)
      // Not "<=", so that what is no number hides nothing and is not hidden.
      if (!(row[x] > nearness)) return false;
  return true;
}

}  // namespace rebake
