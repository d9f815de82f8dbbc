#pragma once

#include <cstddef>
#include <cstdint>

#include "mesh_ops/light/learned/unet_layers.h"

// Interface of the module that trains a Unet with LibTorch. The module is loaded on demand, so that nothing else
// depends on LibTorch. The interface passes plain arrays only.

namespace rebake {

/// A training job: UnetImages and UnetTraining as plain data.
struct UnetTask {
  UnetForm form;
  int side, channels;
  std::size_t poses, held_out;  ///< the held-out poses follow the others in the arrays
  const float* images;          ///< inputs: [pose][6][row][column]
  const float* targets;         ///< expected outputs: [pose][16][row][column]
  int epochs, batch, threads;   ///< `threads`: of the processor
  double rate, last_rate;       ///< learning rate at the start and at the end, along a cosine
  std::uint64_t seed;
  bool cuda;                  ///< train on the graphics card
  std::uint64_t identity;     ///< of everything above; checkpoints of others are refused
  const char* checkpoint;     ///< file to write and to go on from; empty: none
  double checkpoint_seconds;  ///< at least this long between two checkpoints
  /// Called with the finished share 0 … 1 and the mean loss; returns false to cancel; the last checkpoint stays.
  bool (*progress)(void* user, double done, double loss);
  /// Called after each epoch with the mean losses of the training and of the held-out poses (NaN without such).
  void (*epoch)(void* user, int epoch, double loss, double held_out_loss);
  void* user;
};

/// Fills `result` with unet_weight_count() floats: L1 loss, Adam, batch normalisation folded into the convolutions.
/// Returns 0 on success, 1 if cancelled, 2 on failure with `error` filled in. The same seed, threads and processor give
/// the same weights, with and without interruptions between epochs.
using TrainUnet = int (*)(const UnetTask* task, float* result, char* error, std::size_t error_size);
/// Name of the exported TrainUnet function, with the version of this interface: modules of others are not found.
inline constexpr const char* train_unet_symbol = "rebake_train_unet_2";

}  // namespace rebake
