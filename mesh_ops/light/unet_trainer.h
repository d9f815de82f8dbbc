#pragma once

#include <span>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/light/unet.h"

namespace rebake {

/// Poses as images that a Unet learns from, all of one side.
struct UnetImages {
  int side = 64;
  std::size_t poses = 0;
  std::vector<float> images;   ///< [pose][6][row][column]
  std::vector<float> targets;  ///< [pose][16][row][column]
};

struct UnetTraining {
  int channels = 16, epochs = 30, batch = 8;
  double rate = 2e-3;  ///< of learning, at first; it falls along half a cosine
  std::uint64_t seed = 1;
};

/// Whether the module that trains is there: it is built where LibTorch is (samples/install_packages brings it).
bool can_train_unet();
/// Throws Error, which says what to do, where it is not.
void need_unet_training();
/// Throws Error where the module is not there or fails.
Unet trained_unet(const UnetImages& images, const UnetTraining& training, const Progress& progress = {});

}  // namespace rebake
