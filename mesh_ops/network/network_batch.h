#pragma once

#include <cstddef>
#include <cstdint>

// Evaluating and fitting small networks, 16 texels (or observations) at once. Plain arrays: this crosses into a file
// that is compiled for newer processors too, which must share no inline function with any other. Every implementation
// gives the same bits: lanes do not mix, and nothing is contracted or reordered.

namespace rebake {

inline constexpr std::size_t network_lanes = 16;

/// One number of each of 16 texels.
struct alignas(64) Lanes {
  float at[network_lanes];
};

/// Two hidden layers of ReLUs, and logistic outputs.
struct NetworkView {
  std::size_t inputs, hidden0, hidden1, outputs;
  const float* values;  ///< layer by layer, neuron by neuron: its bias, then the weights of its inputs
};
inline constexpr std::size_t texel_features = 8;
inline constexpr std::size_t decoder_inputs = 11;
inline constexpr std::size_t widest_layer = 256;

/// What 16 texels look like along one direction.
struct Sighting {
  Lanes direction[3];  ///< fed direction, unit length
  Lanes target[3];     ///< display colours 0 … 1
  float coverage;      ///< share of a pixel that they cover: the rule scales features and direction by it
  float weight;        ///< of the squared error
  /// 0: each texel alone. Else (1 … 4) the mean of four, as pixels average them: lane l with l + mix, l + 2 mix and
  /// l + 3 mix.
  std::uint32_t mix;
};

/// Values that a feature can be stored as: first + k · step, lowest ≤ k ≤ highest.
struct FeatureLevels {
  float first, step, lowest, highest;
};

struct TexelFit {
  std::size_t iterations = 0;             ///< of damped Gauss–Newton on the 8 features; 0: none
  const FeatureLevels* levels = nullptr;  ///< of the 8 features, to round to; null: not rounded
  bool search = false;                    ///< looks among neighbouring levels for what fits better than the nearest
  std::uint32_t not_searched = 0;         ///< a bit for each feature that takes its nearest level all the same
};

struct NetworkKernels {
  /// Lanes of workspace that the functions below want.
  std::size_t (*workspace)(const NetworkView& network);
  /// outputs[outputs] of inputs[inputs].
  void (*forward)(const NetworkView& network, const Lanes* inputs, Lanes* outputs, Lanes* workspace);
  /// For the inputs and outputs of the forward just before, in the same workspace: `slopes` is the loss's derivative by
  /// the outputs. Adds its derivative by the network's values to `gradient` (as many lanes as values), and writes that
  /// by the inputs to `input_slopes`; either may be null.
  void (*backward)(const NetworkView& network, const Lanes* inputs, const Lanes* outputs, const Lanes* slopes,
                   Lanes* gradient, Lanes* input_slopes, Lanes* workspace);
  /// Fits features[8] (0 … 1) of 16 texels to their sightings with the decoder fixed; `error` becomes the weighted sum
  /// of squared errors over sightings and channels of what is returned.
  void (*fit_texels)(const NetworkView& decoder, const Sighting* sightings, std::size_t count, const TexelFit& fit,
                     Lanes* features, Lanes* error, Lanes* workspace);
};

// One source, compiled once for each kind of processor.
extern const NetworkKernels network_kernels_baseline;
#ifdef REBAKE_WIDE_VECTORS
extern const NetworkKernels network_kernels_v3;
extern const NetworkKernels network_kernels_v4;
#endif

}  // namespace rebake
