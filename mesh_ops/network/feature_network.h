#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/network/network_batch.h"
#include "mesh_ops/texture/decoder.h"

namespace rebake {

/// The implementation for this machine's processor.
const NetworkKernels& network_kernels();
/// All that this processor can run, the widest vectors first.
std::vector<const NetworkKernels*> all_network_kernels();

/// A network of two hidden layers in single precision, as it is trained: ReLUs, then logistic outputs.
struct FeatureNetwork {
  std::size_t inputs, hidden0, hidden1, outputs;
  std::vector<float> values;  ///< as in NetworkView

  /// All zero.
  FeatureNetwork(std::size_t input_count, std::size_t width0, std::size_t width1, std::size_t output_count);
  /// A decoder that is fed directions as they are.
  explicit FeatureNetwork(const Decoder& decoder);

  NetworkView view() const { return {inputs, hidden0, hidden1, outputs, values.data()}; }
  Decoder to_decoder() const;  ///< of one with 11 inputs and 3 outputs
};

/// Random weights of the spread that keeps ReLUs alive (He et al. 2015), uniform; biases 0.
void randomise(FeatureNetwork& network, std::uint64_t seed);

/// The same function with layers of at least `width` neurons. New ones do nothing yet: random weights lead to them,
/// none away from them.
FeatureNetwork widened(const FeatureNetwork& network, std::size_t width, std::uint64_t seed);

/// Adam (Kingma & Ba 2015), β₁ = 0.9, β₂ = 0.99.
class Adam {
 public:
  explicit Adam(std::size_t count) : mean_(count), square_(count) {}
  /// One step of all values.
  void step(std::vector<float>& values, const std::vector<float>& gradient, float rate);
  /// One step of a value on its own: `steps` is how many it has had, this one included.
  void step_one(std::size_t i, float& value, float gradient, float rate, int steps);

 private:
  std::vector<float> mean_, square_;
  int steps_ = 0;
};

/// The rate of a step: falls from 1 to a hundredth along a cosine while `share` goes from 0 to 1.
float falling_rate(double share);

/// Small repeatable random numbers (SplitMix64, Steele et al. 2014): the same on every machine.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31);
  }
  /// Below `count`.
  std::size_t below(std::size_t count) { return static_cast<std::size_t>((next() >> 32) * count >> 32); }
  /// In [0, 1).
  double share() { return static_cast<double>(next() >> 11) * 0x1p-53; }

 private:
  std::uint64_t state_;
};

}  // namespace rebake
