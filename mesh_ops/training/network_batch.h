#pragma once

#include <cstddef>
#include <cstdint>

// Evaluates and fits small networks in batches of 16 texels (or observations). Plain arrays only: the implementation is
// also compiled for newer processors and must share no inline function with other files. All implementations give the
// same bits, because no operation is contracted or reordered.

namespace rebake {

inline constexpr std::size_t network_lanes = 16;

/// One number per texel of a batch of 16.
struct alignas(64) Lanes {
  float at[network_lanes];
};

/// A non-owning view of an MLP in single precision: two hidden ReLU layers and logistic outputs.
struct NetworkView {
  std::size_t inputs, hidden0, hidden1, outputs;  ///< numbers of neurons per layer
  const float* values;  ///< layer by layer, neuron by neuron: its bias, then the weights of its inputs
};
inline constexpr std::size_t texel_features = 8;   ///< features per texel
inline constexpr std::size_t decoder_inputs = 11;  ///< 8 features and 3 components of the direction
inline constexpr std::size_t widest_layer = 256;   ///< largest hidden width that is evaluated in single precision

/// One view sample per texel of a batch of 16: a view direction and the colour to reproduce.
struct ViewSample {
  Lanes direction[3];  ///< unit view direction, as fed to the decoder
  Lanes target[3];     ///< display colour, 0 … 1 per channel
  float coverage;      ///< share of a pixel covered by the texels; scales features and direction
  float weight;        ///< weight of the squared error
  /// 0: each texel alone. 1 … 4: mean of four texels, as in a pixel that averages them: lane l with lanes l + mix, l +
  /// 2 mix and l + 3 mix (modulo 16).
  std::uint32_t mix;
};

/// Quantisation levels of a feature: first + k · step, with integer k, lowest ≤ k ≤ highest.
struct FeatureLevels {
  float first, step, lowest, highest;
};

/// Options of NetworkKernels::fit_texels.
struct TexelFit {
  std::size_t iterations = 0;             ///< damped Gauss–Newton iterations on the 8 features; 0: none
  const FeatureLevels* levels = nullptr;  ///< per feature (8): levels to quantise to; null: no quantisation
  bool search = false;                    ///< searches levels near the nearest ones for a better fit
  std::uint32_t not_searched = 0;         ///< bit mask of features that the search leaves at their nearest level
};

/// Function table of one implementation, for one processor level.
struct NetworkKernels {
  /// Size of the workspace for the functions below, in Lanes.
  std::size_t (*workspace)(const NetworkView& network);
  /// Evaluates outputs[network.outputs] for inputs[network.inputs].
  void (*forward)(const NetworkView& network, const Lanes* inputs, Lanes* outputs, Lanes* workspace);
  /// Backpropagation for the inputs and outputs of the preceding forward(), with the same workspace. `slopes`:
  /// derivatives of the loss by the outputs. Adds its derivatives by the network's values to `gradient` (one Lanes per
  /// value), and writes those by the inputs to `input_slopes`; either may be null.
  void (*backward)(const NetworkView& network, const Lanes* inputs, const Lanes* outputs, const Lanes* slopes,
                   Lanes* gradient, Lanes* input_slopes, Lanes* workspace);
  /// Fits features[8] (0 … 1) of 16 texels to `count` view samples with a fixed decoder. `features` holds the initial
  /// values and receives the result; `error` receives its weighted sum of squared errors over samples and channels.
  void (*fit_texels)(const NetworkView& decoder, const ViewSample* view_samples, std::size_t count, const TexelFit& fit,
                     Lanes* features, Lanes* error, Lanes* workspace);
};

// Compiled from one source file for each processor level.
extern const NetworkKernels network_kernels_baseline;
#ifdef REBAKE_WIDE_VECTORS
extern const NetworkKernels network_kernels_v3;
extern const NetworkKernels network_kernels_v4;
#endif

}  // namespace rebake
