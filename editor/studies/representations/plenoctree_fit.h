#pragma once

#include <functional>

#include "editor/studies/representations/fit_steps.h"
#include "editor/studies/representations/plenoctree.h"
#include "editor/studies/representations/scene_kinds.h"

namespace rebake {

/// Fits densities and spherical harmonics of degree 2 to rays of known colour by Adam on the squared error of colours,
/// then removes leaves that no ray sees. `resolution`: leaves along the cube's side, a power of two. `goes_on` as for
/// fit_snerg(). Deterministic at any number of threads.
PlenOctree fit_plenoctree(const TruthRays& rays, int resolution,
                          const std::function<bool(int passes, const PlenOctree& tree)>& goes_on,
                          const Progress& progress, const FitCheckpoints& checkpoints = {});

}  // namespace rebake
