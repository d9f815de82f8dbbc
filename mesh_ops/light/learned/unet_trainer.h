#pragma once

#include <filesystem>
#include <functional>
#include <limits>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/light/learned/unet.h"

namespace rebake {

/// Training set of a Unet: one geometry image and its target per pose (deformation of the object).
struct UnetImages {
  int side = 64;  ///< pixels per side
  std::size_t poses = 0;
  std::vector<float> images;   ///< [pose][unet_inputs][row][column]: position and normal (see unet.h)
  std::vector<float> targets;  ///< expected outputs: [pose][unet_outputs][row][column] (see unet.h)
  std::size_t held_out = 0;    ///< this number of the last poses is not trained on, but measured after each epoch
};

/// Training parameters. `channels`: those of the finest level, a multiple of 8; `batch`: poses per step.
struct UnetTraining {
  int channels = 16, epochs = 30, batch = 8;
  double rate = 2e-3;  ///< initial learning rate; decays along a cosine to a hundredth
  std::uint64_t seed = 1;
  UnetForm form = UnetForm::added;
  int threads = 1;                     ///< small images do not gain from more
  bool cuda = false;                   ///< on the graphics card; Error if LibTorch finds none
  std::filesystem::path checkpoint{};  ///< file to go on from and to write after epochs; empty: none
  double checkpoint_seconds = 60;      ///< at least this long between two checkpoints
  /// Called after each epoch, if set. L1 losses per output value; NaN without held-out poses.
  std::function<void(int epoch, double loss, double held_out_loss)> watch{};
};

/// Whether the training module is available. It is built if LibTorch is installed (samples/install_packages).
bool can_train_unet();
/// Throws Error with instructions if the training module is not available.
void require_unet_training();
/// Trains a Unet. Throws Error if the module is missing or fails, and std::invalid_argument for sizes that do not
/// match.
Unet train_unet(const UnetImages& images, const UnetTraining& training, const Progress& progress = {});

}  // namespace rebake
