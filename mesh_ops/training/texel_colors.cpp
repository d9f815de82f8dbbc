#include "mesh_ops/training/texel_colors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rebake {

namespace {

// A batch of up to 16 texels, each with a view direction.
class Batch {
 public:
  explicit Batch(const FeatureNetwork& network)
      : network_(network), work_(network_kernels().workspace(network.view())) {}

  void set_features(std::size_t lane, const TexelColors::Features& features) {
    for (std::size_t f = 0; f < texel_features; ++f) inputs_[f].at[lane] = static_cast<float>(features[f]);
  }
  void set_direction(std::size_t lane, const Vec3& direction) {
    for (std::size_t k = 0; k < 3; ++k)
      inputs_[texel_features + k].at[lane] = static_cast<float>(direction[static_cast<Eigen::Index>(k)]);
  }
  void run() {
    // decode_lanes() may overwrite its inputs, but the features serve several directions.
    std::array<Lanes, decoder_inputs> inputs = inputs_;
    decode_lanes(network_, inputs.data(), outputs_.data(), work_.data());
  }
  Color color(std::size_t lane) const {
    return {static_cast<double>(outputs_[0].at[lane]), static_cast<double>(outputs_[1].at[lane]),
            static_cast<double>(outputs_[2].at[lane])};
  }

 private:
  const FeatureNetwork& network_;
  std::vector<Lanes> work_;
  std::array<Lanes, decoder_inputs> inputs_{};
  std::array<Lanes, 3> outputs_{};
};

bool too_wide(const FeatureNetwork& network) { return std::max(network.hidden0, network.hidden1) > widest_layer; }

}  // namespace

TexelColors::TexelColors(const Decoder& decoder, std::vector<Vec3> directions)
    : decoder_(decoder), network_(decoder), directions_(std::move(directions)) {}

void TexelColors::decode_into(std::span<const Features> features, std::span<Color> colors) const {
  const std::size_t count = directions_.size();
  if (too_wide(network_)) {
    for (std::size_t k = 0; k < features.size(); ++k)
      for (std::size_t d = 0; d < count; ++d) colors[k * count + d] = decode(decoder_, features[k], directions_[d]);
    return;
  }
  Batch batch(network_);
  for (std::size_t first = 0; first < features.size(); first += network_lanes) {
    const std::size_t lanes = std::min(network_lanes, features.size() - first);
    for (std::size_t l = 0; l < lanes; ++l) batch.set_features(l, features[first + l]);
    for (std::size_t d = 0; d < count; ++d) {
      for (std::size_t l = 0; l < lanes; ++l) batch.set_direction(l, directions_[d]);
      batch.run();
      for (std::size_t l = 0; l < lanes; ++l) colors[(first + l) * count + d] = batch.color(l);
    }
  }
}

void TexelColors::decode_each(std::span<const Features> features, std::span<const Vec3> directions,
                              std::span<Color> colors) const {
  if (too_wide(network_)) {
    for (std::size_t k = 0; k < features.size(); ++k) colors[k] = decode(decoder_, features[k], directions[k]);
    return;
  }
  Batch batch(network_);
  for (std::size_t first = 0; first < features.size(); first += network_lanes) {
    const std::size_t lanes = std::min(network_lanes, features.size() - first);
    for (std::size_t l = 0; l < lanes; ++l) {
      batch.set_features(l, features[first + l]);
      batch.set_direction(l, directions[first + l]);
    }
    batch.run();
    for (std::size_t l = 0; l < lanes; ++l) colors[first + l] = batch.color(l);
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
