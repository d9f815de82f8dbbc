#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/texture/decoder.h"
#include "mesh_ops/training/network_batch.h"

namespace rebake {

/// The fastest implementation for this processor.
const NetworkKernels& network_kernels();
/// All implementations that this processor can run, widest vectors first.
std::vector<const NetworkKernels*> all_network_kernels();

/// An MLP for training, in single precision: two hidden ReLU layers and logistic outputs. Only decoders of
/// ColorRule::network are trained.
struct FeatureNetwork {
  std::size_t inputs, hidden0, hidden1, outputs;
  std::vector<float> values;  ///< biases and weights, in the order of NetworkView
  ColorRule rule = ColorRule::network;

  /// All weights and biases are 0.
  FeatureNetwork(std::size_t input_count, std::size_t width0, std::size_t width1, std::size_t output_count);
  /// A decoder in single precision; its inputs are 8 features and the fed direction.
  explicit FeatureNetwork(const Decoder& decoder);

  NetworkView view() const { return {inputs, hidden0, hidden1, outputs, values.data()}; }
  Decoder to_decoder() const;  ///< requires 11 inputs and 3 outputs
};

/// Colours of a batch of texels by the decoder's rule; `inputs`: 8 features and the fed direction, which may be
/// overwritten. `work`: as for NetworkKernels.
void decode_lanes(const FeatureNetwork& decoder, Lanes* inputs, Lanes* colors, Lanes* work);

/// He initialisation (He et al. 2015): uniform random weights, biases 0.
void randomise(FeatureNetwork& network, std::uint64_t seed);

/// The same function with hidden layers of at least `width` neurons. New neurons have random input weights and zero
/// weights to existing neurons and outputs.
FeatureNetwork widened(const FeatureNetwork& network, std::size_t width, std::uint64_t seed);

/// Adam optimiser (Kingma and Ba 2015) with β₁ = 0.9 and β₂ = 0.99.
class Adam {
 public:
  explicit Adam(std::size_t count) : mean_(count), square_(count) {}
  /// Updates all values.
  void step(std::vector<float>& values, const std::vector<float>& gradient, float rate);
  /// Updates value `i` only. `steps`: number of updates of this value, including this one.
  void step_one(std::size_t i, float& value, float gradient, float rate, int steps);

 private:
  std::vector<float> mean_, square_;
  int steps_ = 0;
};

/// Cosine schedule of the learning rate: falls from 1 to 0.01 while the share of done steps goes from 0 to 1.
float cosine_rate(double share);

/// Pseudo-random numbers (SplitMix64, Steele et al. 2014), the same on every machine.
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}
  /// 64 random bits.
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31);
  }
  /// Uniform integer in [0, count).
  std::size_t below(std::size_t count) { return static_cast<std::size_t>((next() >> 32) * count >> 32); }
  /// Uniform number in [0, 1).
  double share() { return static_cast<double>(next() >> 11) * 0x1p-53; }

 private:
  std::uint64_t state_;
};

}  // namespace rebake
