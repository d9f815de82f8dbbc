#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mesh_ops/light/learned/unet_layers.h"

namespace rebake {

/// A trained U-Net (unet_layers) with batch normalisation folded into its convolutions.
class Unet {
 public:
  /// Throws std::invalid_argument if `side` is not a positive multiple of unet_side_step() or the number of weights
  /// does not fit.
  Unet(UnetForm form, int side, int channels, std::vector<float> weights);

  /// Evaluates the network: 6 input planes to 16 output planes, both as [channel][row][column]. The same bits on every
  /// processor.
  std::vector<float> run(std::span<const float> image) const;
  UnetForm form() const { return form_; }
  int side() const { return side_; }
  int channels() const { return channels_; }
  const std::vector<float>& weights() const { return weights_; }

 private:
  /// A layer in the layout of Convolution.
  struct Packed {
    UnetLayer layer;
    std::vector<float> weights, bias;
  };
  UnetForm form_;
  int side_, channels_;
  std::vector<float> weights_;
  std::vector<Packed> packed_;
};

}  // namespace rebake
