#pragma once

#include <span>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/light/light_sites.h"
#include "mesh_ops/light/spherical_harmonics.h"
#include "mesh_ops/rays/scene_rays.h"

namespace rebake {

/// Precomputed radiance transfer (Sloan, Kautz and Snyder 2002): of each site the clamped cosine over π where nothing
/// hides the sky, as spherical harmonics. Its product with a sky's radiance is irradiance over π.
struct Transfer {
  std::vector<sh::Coefficients> sites;
  /// Root mean square error over that of the coefficients, as half of the rays says of all. Half of a Fibonacci lattice
  /// is less even than one of as many points: from 64 rays on it says 1 to 2.2 times what it is off by.
  double relative_error = 0;
};

/// Traced over the half space that each site's normal points to, with so many rays that are the same for all sites, as
/// traced_light does; sites without a normal get 0.
Transfer traced_transfer(std::span<const LightSite> sites, const SceneRays& around, int rays,
                         const Progress& progress = {});

/// What becomes of a site's transfer when its surroundings turn with it: right where the part moved rigidly and nothing
/// else hides anything from it.
Transfer turned_transfer(const Transfer& transfer, std::span<const Mat3> turns);

/// Root mean square difference over the root mean square of `truth`; 0 where both are 0.
double relative_difference(const std::vector<sh::Coefficients>& transfer, const std::vector<sh::Coefficients>& truth);

}  // namespace rebake
