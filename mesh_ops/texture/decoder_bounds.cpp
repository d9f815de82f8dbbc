#include "mesh_ops/texture/decoder_bounds.h"

#include <algorithm>
#include <cmath>

namespace rebake {

namespace {

// Exceeds the rounding error of a shader's sums of a hundred terms in single precision.
constexpr double slack = 1e-5;

double logistic(double x) { return 1 / (1 + std::exp(-x)); }

struct Interval {
  Eigen::VectorXd low, high;
};

// Interval arithmetic through a layer without its activation. `spread` widens each neuron's interval.
Interval through(const Interval& x, const Eigen::MatrixXd& weights, const Eigen::VectorXd& bias,
                 const Eigen::VectorXd& spread) {
  const Eigen::MatrixXd positive = weights.cwiseMax(0), negative = weights.cwiseMin(0);
  return {positive.transpose() * x.low + negative.transpose() * x.high + bias - spread,
          positive.transpose() * x.high + negative.transpose() * x.low + bias + spread};
}
Interval rectified(const Interval& x) { return {x.low.cwiseMax(0), x.high.cwiseMax(0)}; }

// Largest contribution of a unit direction to each neuron of the first layer.
Eigen::VectorXd reach_of_direction(const Decoder& decoder) {
  return decoder.weights0.bottomRows(3).colwise().norm().transpose();
}

}  // namespace

DirectionInfluence direction_influence(const Decoder& decoder) {
  DirectionInfluence result;
  auto without = std::make_shared<Decoder>(decoder);
  without->weights0.bottomRows(3).setZero();
  result.without = std::move(without);
  // Lipschitz bound: ReLUs have slopes of at most 1, the logistic function at most 1/4.
  const Eigen::VectorXd first = reach_of_direction(decoder);
  const Eigen::VectorXd second = decoder.weights1.cwiseAbs().transpose() * first;
  const Eigen::VectorXd last = decoder.weights2.cwiseAbs().transpose() * second;
  result.change = std::min(1.0, last.maxCoeff() / 4);
  return result;
}

std::optional<FeatureRange> narrow_feature_range(const FeatureTexture& texture) {
  constexpr int most = 16;
  std::array<int, 8> low, high;
  low.fill(256);
  high.fill(-1);
  for (int row = 0; row < texture.tile_rows(); ++row)
    for (int column = 0; column < texture.tile_columns(); ++column) {
      const TexelTile& tile = *texture.tile(column, row);
      if (tile.opaque_count() == 0) continue;
      const auto texels = tile.texels();
      for (const Texel& texel : *texels) {
        if (!texel.opaque()) continue;
        for (std::size_t k = 0; k < 8; ++k) {
          const int value = k < 4 ? texel.feat0[k] : texel.feat1[k - 4];
          low[k] = std::min(low[k], value);
          high[k] = std::max(high[k], value);
          if (high[k] - low[k] > most) return std::nullopt;
        }
      }
    }
  FeatureRange range;
  if (high[0] < 0) return range;  // no opaque texel, so nothing is decoded
  const auto decoded = [&](const std::array<int, 8>& bytes) {
    Texel texel;
    for (std::size_t k = 0; k < 8; ++k)
      (k < 4 ? texel.feat0[k] : texel.feat1[k - 4]) = static_cast<std::uint8_t>(bytes[k]);
    return decode_features(texel, texture.alpha_code());
  };
  range.any = true;
  range.low = decoded(low);
  range.high = decoded(high);
  return range;
}

void ColorRange::join(const ColorRange& other) {
  low = low.cwiseMin(other.low);
  high = high.cwiseMax(other.high);
}

ColorRange color_range(const Decoder& decoder, const FeatureRange& features, double share) {
  if (decoder.rule != ColorRule::network) share = 1;  // the rule divides by the covered share
  Interval x{Eigen::VectorXd::Zero(Decoder::inputs), Eigen::VectorXd::Zero(Decoder::inputs)};
  for (int k = 0; k < Decoder::features; ++k) {
    x.low[k] = share * features.low[static_cast<std::size_t>(k)];
    x.high[k] = share * features.high[static_cast<std::size_t>(k)];
  }
  // The direction lies in a ball, not a box: its largest contribution enters as `spread`.
  const Interval first = rectified(through(x, decoder.weights0, decoder.bias0, share * reach_of_direction(decoder)));
  const Interval second =
      rectified(through(first, decoder.weights1, decoder.bias1, Eigen::VectorXd::Zero(decoder.hidden1())));
  const Interval last = through(second, decoder.weights2, decoder.bias2, Eigen::VectorXd::Zero(3));
  ColorRange range;
  for (int c = 0; c < 3; ++c) {
    range.low[c] = logistic(last.low[c]) - slack;
    range.high[c] = logistic(last.high[c]) + slack;
    if (decoder.rule == ColorRule::network) continue;
    const bool adds = decoder.rule == ColorRule::diffuse_and_network;
    const auto channel = static_cast<std::size_t>(c) + 1;
    range.low[c] = std::min(1.0, features.low[channel] + (adds ? range.low[c] : 0)) - slack;
    range.high[c] = std::min(1.0, features.high[channel] + (adds ? range.high[c] : 0)) + slack;
  }
  return range;
}

}  // namespace rebake
