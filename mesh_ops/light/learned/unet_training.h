#pragma once

#include <cstddef>
#include <cstdint>

// Interface of the module that trains a Unet with LibTorch. The module is loaded on demand, so that nothing else
// depends on LibTorch. The interface passes plain arrays only.

namespace rebake {

/// A training job: UnetImages and UnetTraining as plain data.
struct UnetTask {
  int side, channels;
  std::size_t poses;
  const float* images;   ///< inputs: [pose][6][row][column]
  const float* targets;  ///< expected outputs: [pose][16][row][column]
  int epochs, batch;
  double rate;  ///< initial learning rate
  std::uint64_t seed;
  /// Called with the finished share 0 … 1 and the mean loss; returns false to cancel.
  bool (*progress)(void* user, double done, double loss);
  void* user;
};

/// Fills `result` with unet_weight_count(channels) floats: L1 loss, Adam, batch normalisation folded into the
/// convolutions. Returns 0 on success, 1 if cancelled, 2 on failure with `error` filled in.
using TrainUnet = int (*)(const UnetTask* task, float* result, char* error, std::size_t error_size);
/// Name of the exported TrainUnet function.
inline constexpr const char* train_unet_symbol = "rebake_train_unet";

}  // namespace rebake
