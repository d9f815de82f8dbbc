#pragma once

#include <cstddef>
#include <vector>

namespace rebake {

// A U-Net of residual blocks over square images (Ronneberger et al. 2015, He et al. 2016): three downsamplings by two,
// each with twice as many channels.
inline constexpr int unet_levels = 3, unet_inputs = 6, unet_outputs = 16;

/// One convolution: numbers of input and output channels, kernel size and stride in pixels. Padded to equal output size
/// at stride 1.
struct UnetLayer {
  int inputs, outputs, kernel, stride;
};
/// The layers in order of application. Throws std::invalid_argument if `channels` is not a positive multiple of 8.
std::vector<UnetLayer> unet_layers(int channels);
/// Number of floats of all layers: per layer the weights [output][input][row][column], then the biases.
std::size_t unet_weight_count(int channels);

}  // namespace rebake
