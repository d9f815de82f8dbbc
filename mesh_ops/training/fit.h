#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/texture/decoder.h"

namespace rebake {

/// Input of fit(): observed colours of texels along view directions, with an equal number of observations per texel.
struct FitProblem {
  std::size_t texel_count = 0;
  std::size_t observations_per_texel = 0;
  std::vector<std::array<float, 3>> fed_directions;  ///< [texel][observation], unit, in the decoder's axes
  std::vector<std::array<float, 3>> colors;          ///< [texel][observation], display colours 0 … 1
  std::vector<std::array<float, 5>>
      hints;  ///< empty, or per texel initial values 0 … 1 of features 3–7, such as its normal
};

struct FitOptions {
  int epochs = 60;              ///< passes over all texels; gains little beyond 60
  int hidden = 16;              ///< width of both hidden layers
  double learning_rate = 0.01;  ///< initial rate of Adam; decays to a hundredth along a cosine
  unsigned seed = 1;
};

struct FitResult {
  Decoder decoder;
  std::vector<std::array<std::uint8_t, 8>>
      features;  ///< [texel][feature], quantised as in split folders: halved alpha, feature 0 at least 1
  std::vector<double> mean_squared_error;   ///< per epoch, over the sampled observations
  double quantised_mean_squared_error = 0;  ///< over all observations, after quantisation
};

/// Jointly fits 8 features per texel and one shared decoder (Adam on the squared error of display colours), then
/// quantises the features and fine-tunes the decoder. A share of observations is trained at partial coverage, with
/// features and directions scaled as the rendering rule does at edges. Deterministic at any number of threads. Throws
/// std::invalid_argument for sizes that do not match.
FitResult fit(const FitProblem& problem, const FitOptions& options, const Progress& progress = {});

}  // namespace rebake
