#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/texture/decoder.h"

namespace rebake {

/// What texels look like: for each texel the same number of observations.
struct FitProblem {
  std::size_t texel_count = 0;
  std::size_t observations_a_texel = 0;
  std::vector<std::array<float, 3>> fed_directions;  ///< texel-major, unit length, in the decoder's axes
  std::vector<std::array<float, 3>> colors;          ///< texel-major, display colours 0 … 1
  std::vector<std::array<float, 5>>
      hints;  ///< empty, or what else is known of each texel, 0 … 1, such as its normal: features 3–7 start there
};

struct FitOptions {
  int epochs = 60;              ///< passes over all texels; the error falls little after 60
  int hidden = 16;              ///< width of both hidden layers
  double learning_rate = 0.01;  ///< of Adam at the start; falls to a hundredth along a cosine
  unsigned seed = 1;
};

struct FitResult {
  Decoder decoder;
  std::vector<std::array<std::uint8_t, 8>>
      features;  ///< quantised as split folders store them: alpha halved, feature 0 at least 1
  std::vector<double> mean_squared_error;   ///< of each epoch, over what it looked at
  double quantised_mean_squared_error = 0;  ///< of all observations, after quantisation
};

/// Fits 8 features a texel and one shared decoder together (Adam on the squared error of display colours), then
/// quantises the features and adjusts the decoder to the quantised ones. A share of observations is shown at partial
/// coverage, scaled as the rendering rule scales features and directions at edges. Deterministic at any number of
/// threads. Throws std::invalid_argument for sizes that do not match.
FitResult fit(const FitProblem& problem, const FitOptions& options, const Progress& progress = {});

}  // namespace rebake
