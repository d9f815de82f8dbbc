#pragma once

#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/light/irradiance.h"

namespace rebake {

struct EstimateOptions {
  std::size_t sites = 3000;  ///< looked at
  int rays = 256;            ///< from each, over each half space
  int lobes = 96;            ///< of the sky
  bool sun = true;           ///< looks for one
};

/// The light that an object was baked in, as far as its colours tell. Scale and tint are those of albedos of ½ on the
/// whole: they cancel where colours are changed by it.
struct LightEstimate {
  Light light;
  /// Share of the colours' variance within surfaces of one chromaticity that it explains, 0 … 1.
  double confidence = 0;
  bool sun = false;  ///< one was found
};

/// Non-negative lobes, what hides them, and a sun where there is one, fitted to linear colours of sites (one each) by
/// robust least squares; albedos are one a cluster of chromaticities, in turn with the light. Deterministic.
LightEstimate estimated_light(const LightSites& sites, const std::vector<Radiance>& colors, const SceneRays& body,
                              const EstimateOptions& options = {}, const Progress& progress = {});

}  // namespace rebake
