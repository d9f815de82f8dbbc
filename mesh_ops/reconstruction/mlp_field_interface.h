#pragma once

#include <cstddef>
#include <cstdint>

// Interface of the module that evaluates and trains the published networks with LibTorch. The module is loaded on
// demand, so that nothing else depends on LibTorch. The interface passes plain arrays only.

namespace rebake {

/// Sizes of the published networks: sines and cosines of `octaves` octaves, `layers` hidden layers, the inputs joined
/// again after the fifth.
struct MlpFieldSizes {
  std::size_t outputs;
  int width, octaves, layers;  ///< published: 384, 10, 8
  float extent;                ///< the unit cube of the points stands for coordinates ±extent
  float bias;                  ///< of the outputs at the start, before the logistic function
  std::uint64_t seed;
};

/// Functions of the module. Those that return int return 0 on success, else 1; error() tells why.
struct MlpFieldModule {
  void* (*create)(const MlpFieldSizes* sizes);  ///< null on failure
  void (*destroy)(void* field);
  std::size_t (*parameters)(const void* field);
  /// `points`: [count][3]; `values`: [count][outputs].
  int (*evaluate)(const void* field, const float* points, std::size_t count, float* values);
  /// As SceneField::backpropagate(); `point_slopes` may be null.
  int (*backpropagate)(void* field, const float* points, std::size_t count, const float* slopes, float* point_slopes);
  int (*step)(void* field, double rate);
  void (*reset_optimiser)(void* field);
  /// State of parameters and optimiser: 3 · parameters + 1 numbers.
  int (*save)(const void* field, float* numbers);
  int (*load)(void* field, const float* numbers);
  const char* (*error)();
};

/// Type and name of the exported function that returns the table.
using GetMlpFieldModule = const MlpFieldModule* (*)();
inline constexpr const char* mlp_field_symbol = "rebake_mlp_field";

}  // namespace rebake
