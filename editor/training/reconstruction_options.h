#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "editor/training/capture.h"
#include "mesh_ops/reconstruction/training_plan.h"

namespace rebake {

/// Options of a training.
struct ReconstructionOptions {
  PhotographSource source;
  HeldOut held_out;
  CaptureKind kind = CaptureKind::object;
  std::optional<double> minutes;  ///< about how long it may take; nothing: the usual number of steps
  std::optional<int> steps;       ///< number of steps; nothing: by `minutes`
  std::optional<int> side;        ///< cells per side of the grid; nothing: by the size of the photographs
  std::optional<double> near;     ///< forward-facing captures: nearest depth; nothing: as the camera file states
  std::optional<double> far;      ///< farthest depth; see `near`
  int seed = 1;
  bool mlp = false;                         ///< the published networks instead of hash grids
  int width = 64, octaves = 6, layers = 4;  ///< of these
  bool gains = true;                        ///< gives photographs gains if their exposures differ
  bool four_rays = true;                    ///< see TrainingPlan
  int samples = 16;                         ///< texels between the corners of a quad
  bool fresh = false;                       ///< starts again instead of going on from a checkpoint
};

/// Throws FieldError.
void check(const ReconstructionOptions& options);

/// The choices that must be the same to go on from a checkpoint. `side`: cells per side of the grid.
nlohmann::json identity_of(const ReconstructionOptions& options, int side);

}  // namespace rebake
