#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "mesh_ops/features/distill/view_samples.h"

namespace rebake {

/// Directions per block of texels: those that features are fitted to, and those that only judge the fit.
inline constexpr std::size_t fitted_directions = 24, held_out_view_directions = 8;

/// PSNR in dB of a mean squared error of colours in [0, 1]; at most 100.
inline double psnr_of(double mean_square) {
  return mean_square > 0 ? std::min(100.0, -10 * std::log10(mean_square)) : 100;
}

/// Sum of the samples' weights over the three colour channels: the divisor of a mean squared error.
inline double weight_of(const std::vector<ViewSample>& view_samples) {
  double sum = 0;
  for (const ViewSample& s : view_samples) sum += 3 * static_cast<double>(s.weight);
  return sum;
}

}  // namespace rebake
