#pragma once

#include <array>
#include <span>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/light/light_sites.h"
#include "mesh_ops/rays/scene_rays.h"
#include "mesh_ops/scene/light.h"

namespace rebake {

/// What reaches a site on its two sides: [0] the one that the normal points to.
struct SiteLight {
  std::array<Radiance, 2> irradiance{Radiance(0, 0, 0), Radiance(0, 0, 0)};  ///< over π
  std::array<float, 2> open{0, 0};  ///< cosine-weighted share of the half space that nothing hides
};

/// By how much two sides are open: the share of the first in what shows, 1, ½ or 0. A side that is as good as closed,
/// or a tenth as open as the other, does not show: the inside of what has one, but for cracks and a missing bottom.
double facing_by_openness(double first, double second);

struct IrradianceOptions {
  int rays = 256;  ///< over each half space; a quarter of that to each sun
};

/// Traced light at sites among `around`, with directions of their space turned by `to_light` into the light's. Cosine
/// Fibonacci points turned by an angle of each site's own (4 % off at 64 rays, 1.3 % at 256), which goes with its
/// tangent: a site that moved rigidly with all that it sees gets the same. Deterministic. `wanted`: of each site 1 for
/// the first side, 2 for the other, 3 for both; empty: both of all.
std::vector<SiteLight> traced_light(std::span<const LightSite> sites, std::span<const std::uint8_t> wanted,
                                    const SceneRays& around, const Light& light, const Mat3& to_light,
                                    const IrradianceOptions& options, const Progress& progress = {});
/// The suns' part of that alone, `rays` to each; nothing of `open`.
std::vector<SiteLight> traced_suns(std::span<const LightSite> sites, std::span<const std::uint8_t> wanted,
                                   const SceneRays& around, const Light& light, const Mat3& to_light, int rays,
                                   const Progress& progress = {});

}  // namespace rebake
