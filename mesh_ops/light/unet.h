#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mesh_ops/light/unet_layers.h"

namespace rebake {

/// A trained U-Net (unet_layers) with batch normalisation folded into its convolutions.
class Unet {
 public:
  /// Throws std::invalid_argument if `side` is not a positive multiple of 64 or the number of weights does not fit.
  Unet(int side, int channels, std::vector<float> weights);

  /// Input 6 planes, output 16 planes, as [channel][row][column]. The same bits on every processor.
  std::vector<float> run(std::span<const float> image) const;
  int side() const { return side_; }
  int channels() const { return channels_; }
  const std::vector<float>& weights() const { return weights_; }

 private:
  struct Packed {
    UnetLayer layer;
    std::vector<float> weights, bias;  ///< in the layout of Convolution
  };
  int side_, channels_;
  std::vector<float> weights_;
  std::vector<Packed> packed_;
};

}  // namespace rebake
