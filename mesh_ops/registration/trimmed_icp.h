#pragma once

#include <cstddef>
#include <optional>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/registration/similarity.h"
#include "mesh_ops/registration/surface_samples.h"

namespace rebake {

struct IcpOptions {
  bool with_scale = true;
  /// Share of the moved points that have a counterpart, 0.01 … 1; nullopt: found in each iteration (fractional RMSD,
  /// Phillips et al. 2007).
  std::optional<double> overlap;
  int iterations = 100;  ///< at most
};

struct IcpResult {
  Similarity motion;   ///< from the places of the moved points as given
  double rms = 0;      ///< root mean square distance of the used points from the planes of their counterparts
  double overlap = 0;  ///< share of the moved points that were used
  int iterations = 0;
  bool converged = false;
  /// Number of directions (of rotation, translation and scale) in which the surfaces slide on each other without
  /// resistance, as planes do; the motion is not changed along them.
  int free_directions = 0;
};

/// Moves `moved` onto `fixed` by trimmed ICP (Chetverikov et al. 2002) with point-to-plane distances (Chen and Medioni
/// 1992), starting from where they are. Counterparts are nearest points whose normals differ by less than 60°, in
/// either direction. Throws Error if one of them has fewer than 50 points.
IcpResult trimmed_icp(const SurfaceSamples& moved, const SurfaceSamples& fixed, const IcpOptions& options,
                      const Progress& progress = {});

}  // namespace rebake
