#pragma once

#include <functional>

#include "editor/studies/representations/fit_steps.h"
#include "editor/studies/representations/scene_kinds.h"
#include "editor/studies/representations/snerg_scene.h"

namespace rebake {

/// Fits a SNeRG grid and its network to rays of known colour by Adam on the squared error of colours. `resolution`:
/// voxels along the longest side. After 1, 2, 4, … passes over the rays, `goes_on` gets the number of passes and the
/// scene, quantised and packed, and says whether to double the number of passes. Deterministic at any number of
/// threads. Throws Error if `checkpoints` start from the state of another fit.
SnergScene fit_snerg(const TruthRays& rays, int resolution,
                     const std::function<bool(int passes, const SnergScene& scene)>& goes_on, const Progress& progress,
                     const FitCheckpoints& checkpoints = {});

}  // namespace rebake
