#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mesh_ops/reconstruction/grid_space.h"

namespace rebake {

/// What a training does, fixed before its first step. The published values are in comments.
struct TrainingPlan {
  CaptureKind kind = CaptureKind::object;
  Affine to_unit = Affine::Identity();  ///< similarity from the scene to the capture's normalised frame
  int side = 64;                        ///< cells per side of the grid (128)
  int boxes = 0;                        ///< nested boxes around an unbounded scene's grid (65)
  Frustum frustum{};                    ///< of a forward capture (slope 0.875, depths 1 to 25)
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
  bool gains = true;          ///< photographs get gains if their exposures differ
  bool four_rays = true;      ///< stage 2 averages four rays per pixel

  bool mlp = false;                         ///< the published networks instead of hash grids
  int width = 64, octaves = 6, layers = 4;  ///< of these (384, 10 and 8)
  std::size_t levels = 8;                   ///< of the hash grids
  int log2_entries = 17;                    ///< most entries per level
  std::size_t hidden = 32;                  ///< width of the fields' networks

  std::size_t steps() const { return soft_steps + binary_steps + feature_steps; }
};

/// A plan with hits, hash grids and losses that suit a kind of capture and a grid, and batches that suit the number of
/// `pixels` of all photographs.
TrainingPlan plan_for(CaptureKind kind, int side, std::size_t pixels, std::uint64_t seed);
/// The plan with its steps scaled to about `steps` in all; more if too few would be left before empty cells are left
/// out, which need to be told from others.
TrainingPlan with_steps(TrainingPlan plan, double steps);
/// How many steps before empty cells are left out take the time of the whole plan (measured on two cores).
double open_steps_of_time(const TrainingPlan& plan);
/// The plan in words: its parts, why others are left out, and the published sizes; a sentence per line.
std::vector<std::string> words_of(const TrainingPlan& plan);

/// The parts of a training.
enum class TrainingStage { soft, binary, features, done };

}  // namespace rebake
