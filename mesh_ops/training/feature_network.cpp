#include "mesh_ops/training/feature_network.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh_ops/base/elementary.h"
#include "mesh_ops/base/processor.h"

namespace rebake {

std::vector<const NetworkKernels*> all_network_kernels() {
  std::vector<const NetworkKernels*> kernels;
#ifdef REBAKE_WIDE_VECTORS
  if (processor_has_v4()) kernels.push_back(&network_kernels_v4);
  if (processor_has_v3()) kernels.push_back(&network_kernels_v3);
#endif
  kernels.push_back(&network_kernels_baseline);
  return kernels;
}

const NetworkKernels& network_kernels() {
  static const NetworkKernels* const best = all_network_kernels().front();
  return *best;
}

FeatureNetwork::FeatureNetwork(std::size_t input_count, std::size_t width0, std::size_t width1,
                               std::size_t output_count)
    : inputs(input_count),
      hidden0(width0),
      hidden1(width1),
      outputs(output_count),
      values(width0 * (input_count + 1) + width1 * (width0 + 1) + output_count * (width1 + 1)) {}

FeatureNetwork::FeatureNetwork(const Decoder& d)
    : FeatureNetwork(decoder_inputs, static_cast<std::size_t>(d.hidden0()), static_cast<std::size_t>(d.hidden1()), 3) {
  float* value = values.data();
  const auto layer = [&value](const Eigen::MatrixXd& weights, const Eigen::VectorXd& bias) {
    for (Eigen::Index j = 0; j < bias.size(); ++j) {
      *value++ = static_cast<float>(bias[j]);
      for (Eigen::Index i = 0; i < weights.rows(); ++i) *value++ = static_cast<float>(weights(i, j));
    }
  };
  layer(d.weights0, d.bias0);
  layer(d.weights1, d.bias1);
  layer(d.weights2, d.bias2);
  rule = d.rule;
}

void decode_lanes(const FeatureNetwork& decoder, Lanes* inputs, Lanes* colors, Lanes* work) {
  if (decoder.rule != ColorRule::network)
    for (std::size_t l = 0; l < network_lanes; ++l) {
      const float share = inputs[0].at[l];
      for (std::size_t c = 0; c < decoder_inputs; ++c) inputs[c].at[l] /= share;
    }
  if (decoder.rule != ColorRule::diffuse) network_kernels().forward(decoder.view(), inputs, colors, work);
  if (decoder.rule == ColorRule::network) return;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t l = 0; l < network_lanes; ++l) {
      const float diffuse = inputs[c + 1].at[l];
      colors[c].at[l] = decoder.rule == ColorRule::diffuse ? diffuse : std::min(1.0F, diffuse + colors[c].at[l]);
    }
}

Decoder FeatureNetwork::to_decoder() const {
  Decoder d;
  const float* value = values.data();
  const auto layer = [&value](Eigen::MatrixXd& weights, Eigen::VectorXd& bias, std::size_t from, std::size_t to) {
    const auto rows = static_cast<Eigen::Index>(from), columns = static_cast<Eigen::Index>(to);
    weights.resize(rows, columns);
    bias.resize(columns);
    for (Eigen::Index j = 0; j < columns; ++j) {
      bias[j] = *value++;
      for (Eigen::Index i = 0; i < rows; ++i) weights(i, j) = *value++;
    }
  };
  layer(d.weights0, d.bias0, inputs, hidden0);
  layer(d.weights1, d.bias1, hidden0, hidden1);
  layer(d.weights2, d.bias2, hidden1, outputs);
  d.rule = rule;
  return d;
}

void randomise(FeatureNetwork& network, std::uint64_t seed) {
  SplitMix64 dice(seed);
  float* value = network.values.data();
  for (const auto& [from, to] :
       {std::pair(network.inputs, network.hidden0), std::pair(network.hidden0, network.hidden1),
        std::pair(network.hidden1, network.outputs)})
    for (std::size_t j = 0; j < to; ++j) {
      *value++ = 0;
      for (std::size_t i = 0; i < from; ++i)
        *value++ = static_cast<float>((2 * dice.share() - 1) * std::sqrt(6.0 / static_cast<double>(from)));
    }
}

FeatureNetwork widened(const FeatureNetwork& network, std::size_t width, std::uint64_t seed) {
  FeatureNetwork wide(network.inputs, std::max(width, network.hidden0), std::max(width, network.hidden1),
                      network.outputs);
  randomise(wide, seed);
  const float* from = network.values.data();
  float* to = wide.values.data();
  const auto layer = [&](std::size_t inputs, std::size_t outputs, std::size_t wide_inputs, std::size_t wide_outputs) {
    for (std::size_t j = 0; j < wide_outputs; ++j, to += wide_inputs + 1) {
      if (j >= outputs) continue;
      std::copy_n(from, inputs + 1, to);
      std::fill(to + inputs + 1, to + wide_inputs + 1, 0.0F);
      from += inputs + 1;
    }
  };
  layer(network.inputs, network.hidden0, wide.inputs, wide.hidden0);
  layer(network.hidden0, network.hidden1, wide.hidden0, wide.hidden1);
  layer(network.hidden1, network.outputs, wide.hidden1, wide.outputs);
  return wide;
}

namespace {

constexpr float beta1 = 0.9F, beta2 = 0.99F, tiny = 1e-8F;

// 1 − beta^steps, by multiplications only: the same bits on every processor.
float correction(float beta, int steps) {
  float power = 1, square = beta;
  for (; steps > 0; steps /= 2, square *= square)
    if (steps % 2 != 0) power *= square;
  return 1 - power;
}

}  // namespace

void Adam::step(std::vector<float>& values, const std::vector<float>& gradient, float rate) {
  ++steps_;
  const float correction1 = correction(beta1, steps_), correction2 = correction(beta2, steps_);
  for (std::size_t i = 0; i < values.size(); ++i) {
    mean_[i] = beta1 * mean_[i] + (1 - beta1) * gradient[i];
    square_[i] = beta2 * square_[i] + (1 - beta2) * gradient[i] * gradient[i];
    values[i] -= rate * (mean_[i] / correction1) / (std::sqrt(square_[i] / correction2) + tiny);
  }
}

void Adam::step_one(std::size_t i, float& value, float gradient, float rate, int steps) {
  mean_[i] = beta1 * mean_[i] + (1 - beta1) * gradient;
  square_[i] = beta2 * square_[i] + (1 - beta2) * gradient * gradient;
  value -= rate * (mean_[i] / correction(beta1, steps)) / (std::sqrt(square_[i] / correction(beta2, steps)) + tiny);
}

float cosine_rate(double share) {
  return static_cast<float>(0.01 + 0.99 * 0.5 * (1 + elementary::sine_cosine(std::numbers::pi * share).cosine));
}

}  // namespace rebake
