#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "mesh_ops/base/results.h"
#include "mesh_ops/light/gloss.h"
#include "mesh_ops/light/irradiance.h"
#include "mesh_ops/light/light_estimate.h"
#include "mesh_ops/light/occluder.h"
#include "mesh_ops/light/transfer.h"

namespace rebake {

/// traced_light(), from where such results are kept if it is there; rounded to floats where they are. `results` may be
/// null. `first_lets_through`, where it is there, is asked when something must be traced: kept_open_rays() of the first
/// occluder, the same sites, sides, suns and rays, with `to_light` the identity. The first occluder is not asked then.
std::vector<SiteLight> kept_light(const std::vector<LightSite>& sites, const std::vector<std::uint8_t>& wanted,
                                  const std::vector<Occluder>& occluders, const Light& light, const Mat3& to_light,
                                  int rays, Results* results, const Progress& progress,
                                  const std::function<const OpenRays&()>& first_lets_through = {});

/// The rays that an occluder lets through, likewise kept; suns stand in the sites' space.
OpenRays kept_open_rays(const std::vector<LightSite>& sites, const std::vector<std::uint8_t>& wanted,
                        const Occluder& occluder, const std::vector<Sun>& suns, int rays, Results* results,
                        const Progress& progress);

/// Transfer of what each site shows, by the share of its first side in that.
std::vector<sh::Coefficients> shown_transfer(const std::vector<LightSite>& sites, const std::vector<float>& facing,
                                             const SceneRays& around, int rays, const Progress& progress = {});
/// The same, likewise kept.
std::vector<sh::Coefficients> kept_transfer(const std::vector<LightSite>& sites, const std::vector<float>& facing,
                                            const std::vector<Occluder>& occluders, int rays, Results* results,
                                            const Progress& progress);

/// Charts of all texture sets, with nodes `spacing` texels apart, wider where there would be more than `most_nodes`.
std::vector<std::shared_ptr<const LightChart>> light_charts(const BakedObject& object, double spacing,
                                                            std::size_t most_nodes);

/// The light that an object stood in as it was baked, likewise kept.
LightEstimate kept_estimate(const BakedObject& body, double spacing, std::size_t most_nodes, Results* results,
                            const Progress& progress);

/// found_gloss() among a body, likewise kept.
GlossFit kept_gloss(const BakedObject& object, const std::vector<std::shared_ptr<const LightChart>>& charts,
                    const LightSites& sites, const std::vector<float>& facing, const std::vector<Radiance>& colors,
                    const Light& light, const std::vector<SiteLight>& baked, const Occluder& body, Results* results);

}  // namespace rebake
