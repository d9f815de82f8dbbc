#pragma once

#include <cstddef>
#include <vector>

namespace rebake {

// U-Nets of residual blocks over square images (Ronneberger et al. 2015, He et al. 2016). Each downsampling, by a
// stride of two, doubles the number of channels.
inline constexpr int unet_inputs = 6, unet_outputs = 16;

/// Form of a U-Net.
enum class UnetForm {
  added,  ///< three downsamplings, skip connections are added, no function after the last layer
  /// Four downsamplings, skip connections are concatenated, a sigmoid after the last layer. With 32 channels it has the
  /// 11.79 million parameters of deep precomputed radiance transfer as published.
  concatenated
};

/// Number of downsamplings.
constexpr int unet_levels(UnetForm form) { return form == UnetForm::added ? 3 : 4; }
/// The side of the image, in pixels, must be a multiple of this number.
constexpr int unet_side_step(UnetForm form) { return form == UnetForm::added ? 64 : 32; }

/// One convolution: numbers of input and output channels, kernel size and stride in pixels. Padded to equal output size
/// at stride 1. All but the last are followed by batch normalisation in training.
struct UnetLayer {
  int inputs, outputs, kernel, stride;
};
/// The layers in order of application. Throws std::invalid_argument if `channels`, those of the finest level, is not a
/// positive multiple of 8.
std::vector<UnetLayer> unet_layers(UnetForm form, int channels);
/// Number of floats of all layers: per layer the weights [output][input][row][column], then the biases.
std::size_t unet_weight_count(UnetForm form, int channels);
/// Number of parameters with batch normalisation, as its training frameworks count them: weights and biases, and four
/// numbers per normalised channel.
std::size_t unet_parameter_count(UnetForm form, int channels);

}  // namespace rebake
