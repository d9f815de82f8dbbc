#pragma once

#include <cstddef>
#include <cstdint>

// Training a Unet with LibTorch, which lives in a module of its own that is loaded when something is trained: nothing
// else waits for LibTorch, or needs it. Plain arrays cross the border.

namespace rebake {

struct UnetTask {
  int side, channels;
  std::size_t poses;
  const float* images;   ///< [pose][6][row][column]
  const float* targets;  ///< [pose][16][row][column]
  int epochs, batch;
  double rate;  ///< of learning, at first
  std::uint64_t seed;
  /// Told the share that is done and the mean loss; false stops.
  bool (*progress)(void* user, double done, double loss);
  void* user;
};

/// Fills `result` with unet_weight_count(channels) floats: L1 loss, Adam, batch normalisation folded into the
/// convolutions. Returns 0, 1 where it was stopped, and 2 with `error` filled in where it failed.
using TrainUnet = int (*)(const UnetTask* task, float* result, char* error, std::size_t error_size);
inline constexpr const char* train_unet_symbol = "rebake_train_unet";

}  // namespace rebake
