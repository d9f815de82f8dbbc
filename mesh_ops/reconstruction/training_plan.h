#pragma once

#include <cstdint>

#include "mesh_ops/reconstruction/grid_space.h"

namespace rebake {

/// What a training does, fixed before its first step. The published values are in comments.
struct TrainingPlan {
  CaptureKind kind = CaptureKind::object;
  Affine to_unit = Affine::Identity();  ///< similarity from the scene to the capture's normalised frame
  int side = 64;                        ///< cells per side of the grid (128)
  std::uint64_t seed = 1;

  std::size_t open_steps = 1500;     ///< of stage 1, before empty cells are left out (50,000)
  std::size_t soft_steps = 6000;     ///< stage 1, with those (200,000)
  std::size_t binary_steps = 8000;   ///< stage 2 with soft and binary opacity (up to 400,000)
  std::size_t feature_steps = 3000;  ///< stage 2 with fixed surface (100,000)
  std::size_t open_rays = 512, soft_rays = 1024, pixels = 512;   ///< per step (2048 to 8192 on each of 8 GPUs)
  std::size_t open_hits = 192, soft_hits = 96, pixel_hits = 48;  ///< most hits per ray (3, 1½ and ¾ times the side)
  double rate = 2e-3;         ///< first learning rate of stage 1 (1e-3); falls to a hundredth
  double binary_rate = 5e-4;  ///< learning rate of stage 2 (1e-5); falls to a tenth
  double distortion = 0;      ///< weight of the distortion loss: 0 object, 0.01 forward, 0.001 unbounded
  bool four_rays = true;      ///< stage 2 averages four rays per pixel

  std::size_t levels = 8;   ///< of the hash grids
  int log2_entries = 17;    ///< most entries per level
  std::size_t hidden = 32;  ///< width of the fields' networks

  std::size_t steps() const { return soft_steps + binary_steps + feature_steps; }
};

/// The parts of a training.
enum class TrainingStage { soft, binary, features, done };

}  // namespace rebake
