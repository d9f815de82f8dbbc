#include "mesh_ops/light/learned/dprt_ranges.h"

#include <algorithm>
#include <limits>

namespace rebake {

DprtRanges::DprtRanges() {
  seen_.low.fill(std::numeric_limits<float>::infinity());
  seen_.high.fill(-std::numeric_limits<float>::infinity());
}

void DprtRanges::add(const std::vector<Vec3>& places, std::span<const float> coefficients) {
  for (const Vec3& place : places) box_.extend(place);
  const std::size_t texels = coefficients.size() / sh::count;
  for (std::size_t c = 0; c < sh::count; ++c) {
    const auto plane = coefficients.subspan(c * texels, texels);
    const auto [low, high] = std::minmax_element(plane.begin(), plane.end());
    seen_.low[c] = std::min(seen_.low[c], *low);
    seen_.high[c] = std::max(seen_.high[c], *high);
  }
}

DprtNetwork::Ranges DprtRanges::found() const {
  constexpr float margin = 0.05F;
  DprtNetwork::Ranges ranges = seen_;
  for (std::size_t c = 0; c < sh::count; ++c) {
    const float room = margin * (ranges.high[c] - ranges.low[c]);
    ranges.low[c] -= room;
    ranges.high[c] += room;
  }
  ranges.center = box_.center();
  ranges.reach = box_.sizes().maxCoeff() / 2;
  return ranges;
}

std::vector<float> dprt_targets(std::span<const float> coefficients, const DprtNetwork::Ranges& ranges) {
  std::vector<float> targets(coefficients.begin(), coefficients.end());
  const std::size_t texels = coefficients.size() / sh::count;
  for (std::size_t c = 0; c < sh::count; ++c) {
    const float range = ranges.high[c] - ranges.low[c];
    for (std::size_t t = 0; t < texels; ++t) {
      float& value = targets[c * texels + t];
      value = range > 0 ? (value - ranges.low[c]) / range : 0.5F;
    }
  }
  return targets;
}

}  // namespace rebake
