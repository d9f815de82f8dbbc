#include "mesh_ops/light/learned/unet_layers.h"

#include <stdexcept>

namespace rebake {

std::vector<UnetLayer> unet_layers(UnetForm form, int channels) {
  if (channels < 8 || channels % 8 != 0) throw std::invalid_argument("channels must be a positive multiple of 8");
  std::vector<UnetLayer> result{{unet_inputs, channels, 3, 1}};
  const auto residual = [&](int c) {
    result.push_back({c, c, 3, 1});
    result.push_back({c, c, 3, 1});
  };
  const int levels = unet_levels(form);
  for (int l = 0; l < levels; ++l) {
    residual(channels << l);
    result.push_back({channels << l, channels << (l + 1), 3, 2});
  }
  residual(channels << levels);
  for (int l = levels - 1; l >= 0; --l) {
    const int skipped = form == UnetForm::concatenated ? channels << l : 0;
    result.push_back({(channels << (l + 1)) + skipped, channels << l, 3, 1});
    residual(channels << l);
  }
  result.push_back({channels, unet_outputs, 1, 1});
  return result;
}

std::size_t unet_weight_count(UnetForm form, int channels) {
  std::size_t count = 0;
  for (const UnetLayer& layer : unet_layers(form, channels))
    count += static_cast<std::size_t>(layer.outputs * (layer.inputs * layer.kernel * layer.kernel + 1));
  return count;
}

std::size_t unet_parameter_count(UnetForm form, int channels) {
  constexpr std::size_t of_normalisation = 4;
  std::size_t count = unet_weight_count(form, channels);
  for (const UnetLayer& layer : unet_layers(form, channels))
    if (layer.kernel > 1) count += of_normalisation * static_cast<std::size_t>(layer.outputs);
  return count;
}

}  // namespace rebake
