#pragma once

#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/light/transport/irradiance.h"

namespace rebake {

struct EstimateOptions {
  std::size_t sites = 3000;  ///< number of sampled sites
  int rays = 256;            ///< rays per site and half space
  int lobes = 96;            ///< number of lobes of the sky
  bool sun = true;           ///< whether to search for a sun
};

/// Estimate of the light that an object was baked in. Scale and tint assume a mean albedo of ½; they cancel when
/// colours are corrected.
struct LightEstimate {
  Light light;
  /// Explained share of the variance of colours within clusters of one chromaticity, 0 … 1.
  double confidence = 0;
  bool sun = false;  ///< whether a sun was found
};

/// Fits non-negative lobes, their visibility past `body`, and a sun to the linear `colors` of sites, by robust least
/// squares that alternates between the light and one albedo per chromaticity cluster. Deterministic.
LightEstimate estimated_light(const LightSites& sites, const std::vector<Radiance>& colors, const SceneRays& body,
                              const EstimateOptions& options = {}, const Progress& progress = {});

}  // namespace rebake
