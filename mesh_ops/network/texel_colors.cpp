#include "mesh_ops/network/texel_colors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rebake {

TexelColors::TexelColors(const Decoder& decoder, std::vector<Vec3> directions)
    : decoder_(decoder), network_(decoder), directions_(std::move(directions)) {}

void TexelColors::decode_into(std::span<const Features> features, std::span<Color> colors) const {
  const std::size_t count = directions_.size();
  if (std::max(network_.hidden0, network_.hidden1) > widest_layer) {
    for (std::size_t k = 0; k < features.size(); ++k)
      for (std::size_t d = 0; d < count; ++d) colors[k * count + d] = decode(decoder_, features[k], directions_[d]);
    return;
  }
  const NetworkKernels& kernels = network_kernels();
  std::vector<Lanes> work(kernels.workspace(network_.view()));
  std::array<Lanes, decoder_inputs> inputs{};
  std::array<Lanes, 3> outputs{};
  for (std::size_t first = 0; first < features.size(); first += network_lanes) {
    const std::size_t lanes = std::min(network_lanes, features.size() - first);
    for (std::size_t l = 0; l < lanes; ++l)
      for (std::size_t f = 0; f < texel_features; ++f) inputs[f].at[l] = static_cast<float>(features[first + l][f]);
    for (std::size_t d = 0; d < count; ++d) {
      for (std::size_t k = 0; k < 3; ++k)
        std::fill_n(inputs[texel_features + k].at, network_lanes,
                    static_cast<float>(directions_[d][static_cast<Eigen::Index>(k)]));
      kernels.forward(network_.view(), inputs.data(), outputs.data(), work.data());
      for (std::size_t l = 0; l < lanes; ++l)
        colors[(first + l) * count + d] = {static_cast<double>(outputs[0].at[l]), static_cast<double>(outputs[1].at[l]),
                                           static_cast<double>(outputs[2].at[l])};
    }
  }
}

void TexelColors::decode_each(std::span<const Features> features, std::span<const Vec3> directions,
                              std::span<Color> colors) const {
  if (std::max(network_.hidden0, network_.hidden1) > widest_layer) {
    for (std::size_t k = 0; k < features.size(); ++k) colors[k] = decode(decoder_, features[k], directions[k]);
    return;
  }
  const NetworkKernels& kernels = network_kernels();
  std::vector<Lanes> work(kernels.workspace(network_.view()));
  std::array<Lanes, decoder_inputs> inputs{};
  std::array<Lanes, 3> outputs{};
  for (std::size_t first = 0; first < features.size(); first += network_lanes) {
    const std::size_t lanes = std::min(network_lanes, features.size() - first);
    for (std::size_t l = 0; l < lanes; ++l) {
      for (std::size_t f = 0; f < texel_features; ++f) inputs[f].at[l] = static_cast<float>(features[first + l][f]);
      for (std::size_t k = 0; k < 3; ++k)
        inputs[texel_features + k].at[l] = static_cast<float>(directions[first + l][static_cast<Eigen::Index>(k)]);
    }
    kernels.forward(network_.view(), inputs.data(), outputs.data(), work.data());
    for (std::size_t l = 0; l < lanes; ++l)
      colors[first + l] = {static_cast<double>(outputs[0].at[l]), static_cast<double>(outputs[1].at[l]),
                           static_cast<double>(outputs[2].at[l])};
  }
}

std::vector<Vec3> even_directions(std::size_t count) {
  std::vector<Vec3> directions;
  for (std::size_t k = 0; k < count; ++k) {
    const double z = 1 - (2 * static_cast<double>(k) + 1) / static_cast<double>(count),
                 angle = std::numbers::pi * (3 - std::sqrt(5.0)) * static_cast<double>(k), r = std::sqrt(1 - z * z);
    directions.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return directions;
}

}  // namespace rebake
