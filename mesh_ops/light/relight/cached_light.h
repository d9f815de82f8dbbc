#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "mesh_ops/base/result_cache.h"
#include "mesh_ops/light/estimate/light_estimate.h"
#include "mesh_ops/light/transport/gloss.h"
#include "mesh_ops/light/transport/irradiance.h"
#include "mesh_ops/light/transport/occluder.h"
#include "mesh_ops/light/transport/transfer.h"

namespace rebake {

/// traced_light() with the cache `results`, which may be null; cached results are rounded to floats.
/// `first_open_rays`, if given, is called on a cache miss and returns cached_open_rays() of the first occluder for the
/// same sites, sides, suns and rays, with `to_light` the identity; the first occluder is not traced then.
std::vector<SiteLight> cached_light(const std::vector<LightSite>& sites, const std::vector<std::uint8_t>& wanted,
                                    const std::vector<Occluder>& occluders, const Light& light, const Mat3& to_light,
                                    int rays, ResultCache* results, const Progress& progress,
                                    const std::function<const VisibilityFlags&()>& first_open_rays = {});

/// Visibility of rays past one occluder, cached. Sun directions are in the sites' space.
VisibilityFlags cached_open_rays(const std::vector<LightSite>& sites, const std::vector<std::uint8_t>& wanted,
                                 const Occluder& occluder, const std::vector<Sun>& suns, int rays, ResultCache* results,
                                 const Progress& progress);

/// Transfer of the visible surface of each site; `facing` is the share of its first side, 0 … 1.
std::vector<sh::Coefficients> visible_transfer(const std::vector<LightSite>& sites, const std::vector<float>& facing,
                                               const SceneRays& around, int rays, const Progress& progress = {});
/// The same, cached.
std::vector<sh::Coefficients> cached_transfer(const std::vector<LightSite>& sites, const std::vector<float>& facing,
                                              const std::vector<Occluder>& occluders, int rays, ResultCache* results,
                                              const Progress& progress);

/// Charts of all texture sets, with nodes `spacing` texels apart, or farther to stay within `max_nodes`.
std::vector<std::shared_ptr<const LightChart>> light_charts(const BakedObject& object, double spacing,
                                                            std::size_t max_nodes);

/// estimated_light() of an object, cached.
LightEstimate cached_estimate(const BakedObject& body, double spacing, std::size_t max_nodes, ResultCache* results,
                              const Progress& progress);

/// fitted_gloss() with the occluder `body`, cached.
GlossFit cached_gloss(const BakedObject& object, const std::vector<std::shared_ptr<const LightChart>>& charts,
                      const LightSites& sites, const std::vector<float>& facing, const std::vector<Radiance>& colors,
                      const Light& light, const std::vector<SiteLight>& baked, const Occluder& body,
                      ResultCache* results);

}  // namespace rebake
