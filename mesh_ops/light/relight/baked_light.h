#pragma once

#include <map>
#include <memory>
#include <vector>

#include "mesh_ops/light/relight/cached_light.h"
#include "mesh_ops/light/relight/lighting_options.h"
#include "mesh_ops/light/transport/gloss.h"

namespace rebake {

/// Light data of an object that does not depend on its placement: sites, their colours, and the light it was baked in.
/// All nodes of the object share it.
class BakedLight {
 public:
  /// `options` must outlive this object.
  BakedLight(std::shared_ptr<const BakedObject> object, const SceneLight& settings, const LightingOptions& options,
             const Progress& progress);

  std::vector<std::shared_ptr<const LightChart>> charts;  ///< per texture set
  LightSites sites;                                       ///< at the nodes of all charts
  std::vector<Radiance> colors;                           ///< per site: linear colour, the mean over both sides
  std::vector<float> facing;                              ///< per site: facing_of()
  std::vector<std::uint8_t> sides;     ///< per site: visible sides, as the `wanted` of traced_light()
  std::shared_ptr<const Light> light;  ///< the light as baked, given or estimated
  double confidence = 0;               ///< of the estimated `light`, 0 … 1; 1 if it was given
  Radiance albedo{1, 1, 1};            ///< per channel: 90 % of the sites stay below this

  /// Specular fit, computed on the first call. Only for objects for which has_single_body() holds.
  const std::shared_ptr<const GlossFit>& gloss();
  /// Whether the object has a single body, in its original place.
  bool has_single_body() const { return bodies_.size() == 1 && bodies_.front().to_object.matrix().isIdentity(0); }
  /// Linear colour of each site, averaged over its visible sides.
  const std::vector<Radiance>& visible_colors();
  /// Light on the `wanted` sides as baked; on all sides if `wanted` is empty. `rays`: per half space.
  std::vector<SiteLight> as_baked(const std::vector<std::uint8_t>& wanted, int rays, const Progress& progress);
  const std::shared_ptr<const BakedObject>& object() const { return object_; }
  /// Whether the object's geometry is the one that its light was baked on.
  bool untouched() const { return untouched_; }
  /// Light on the visible sides of an untouched object with `others` around it.
  std::vector<SiteLight> among(const std::vector<Occluder>& others, int rays, const Progress& progress);
  /// The `wanted` sides (all sides if empty) that belong to a body.
  std::vector<std::uint8_t> of_body(std::size_t body, const std::vector<std::uint8_t>& wanted) const;
  /// cached_light() with the cache of the options.
  std::vector<SiteLight> traced(const std::vector<LightSite>& at, const std::vector<std::uint8_t>& wanted,
                                const std::vector<Occluder>& occluders, const Light& in, const Mat3& to_light, int rays,
                                const Progress& progress) const;

 private:
  std::shared_ptr<const BakedObject> object_;
  std::vector<BakedBody> bodies_;
  bool untouched_;
  const LightingOptions& options_;
  std::vector<SiteLight> coarse_light_;  ///< light on both sides as baked, traced with 64 rays
  std::shared_ptr<const GlossFit> gloss_;
  std::vector<Radiance> shown_colors_;
  std::map<int, std::vector<SiteLight>> visible_light_;  ///< light on the visible sides as baked, by number of rays
  std::map<int, VisibilityFlags> open_;  ///< rays of visible sides that pass the object, by number of rays
};

/// BakedLight of all objects of a scene, created on first request. Objects that were read from the same files share
/// one.
class BakedLights {
 public:
  BakedLights(const SceneLight& settings, const LightingOptions& options) : settings_(settings), options_(options) {}
  std::shared_ptr<BakedLight> of(const std::shared_ptr<const BakedObject>& object, const Progress& progress);

 private:
  const SceneLight& settings_;
  const LightingOptions& options_;
  std::vector<std::shared_ptr<BakedLight>> made_;
};

}  // namespace rebake
