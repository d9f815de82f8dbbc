#pragma once

#include <span>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/light/transport/light_sites.h"
#include "mesh_ops/light/transport/spherical_harmonics.h"
#include "mesh_ops/rays/scene_rays.h"

namespace rebake {

/// Precomputed radiance transfer (Sloan, Kautz and Snyder 2002): per site the clamped cosine divided by π times the
/// visibility of the sky, as spherical harmonics. Its dot product with a sky's radiance is irradiance / π.
struct Transfer {
  std::vector<sh::Coefficients> sites;
  /// Relative root mean square error, estimated from half of the rays. Half of a Fibonacci lattice is less even than a
  /// lattice of that size, so from 64 rays on this is 1 to 2.2 times the true error.
  double relative_error = 0;
};

/// Traces the half space on the normal's side of each site with `rays` directions shared by all sites, as
/// traced_light() does. Sites without a normal get 0.
Transfer traced_transfer(std::span<const LightSite> sites, const SceneRays& around, int rays,
                         const Progress& progress = {});

/// Transfer rotated with its surroundings: exact if the part moved rigidly and nothing else occludes it.
Transfer rotated_transfer(const Transfer& transfer, std::span<const Mat3> turns);

/// Root mean square difference divided by the root mean square of `truth`; 0 if both are 0.
double relative_difference(const std::vector<sh::Coefficients>& transfer, const std::vector<sh::Coefficients>& truth);

}  // namespace rebake
