#pragma once

#include <cstddef>
#include <vector>

namespace rebake {

// A U-Net of residual blocks over square images (Ronneberger et al. 2015, He et al. 2016): three times halved, twice as
// many channels each time.
inline constexpr int unet_levels = 3, unet_inputs = 6, unet_outputs = 16;

/// One convolution.
struct UnetLayer {
  int inputs, outputs, kernel, stride;
};
/// In the order in which they are applied. Throws std::invalid_argument for channels that are not a positive multiple
/// of 8.
std::vector<UnetLayer> unet_layers(int channels);
/// Floats of all layers: of each its weights [output][input][row][column], then its biases.
std::size_t unet_weight_count(int channels);

}  // namespace rebake
