#pragma once

#include <map>
#include <memory>
#include <vector>

#include "mesh_ops/light/gloss.h"
#include "mesh_ops/light/kept_light.h"
#include "mesh_ops/light/lighting.h"

namespace rebake {

/// Light data of an object that does not depend on its placement: sites, their colours, and the light it was baked in.
/// Shared by all nodes of the object.
class BakedLight {
 public:
  /// `options` must outlive this object.
  BakedLight(std::shared_ptr<const BakedObject> object, const SceneLight& settings, const LightingOptions& options,
             const Progress& progress);

  std::vector<std::shared_ptr<const LightChart>> charts;
  LightSites sites;
  std::vector<Radiance> colors;  ///< linear, per site; the same for both sides
  std::vector<float> facing;
  std::vector<std::uint8_t> sides;  ///< visible sides per site, as the `wanted` of traced_light()
  std::shared_ptr<const Light> light;
  double confidence = 0;     ///< of `light` if it was estimated, 0 … 1
  Radiance albedo{1, 1, 1};  ///< upper bound for 90 % of the sites

  /// Specular fit; available for objects with a single, unrotated body.
  const std::shared_ptr<const GlossFit>& gloss();
  bool may_mirror() const { return bodies_.size() == 1 && bodies_.front().to_object.matrix().isIdentity(0); }
  /// Colours of the visible sides.
  const std::vector<Radiance>& shown_colors();
  /// Light on the `wanted` sides as baked; on all sides if `wanted` is empty.
  std::vector<SiteLight> as_baked(const std::vector<std::uint8_t>& wanted, int rays, const Progress& progress);
  const std::shared_ptr<const BakedObject>& object() const { return object_; }
  /// Whether the object's geometry is the one that its light was baked on.
  bool untouched() const { return untouched_; }
  /// Light on the visible sides of an untouched object with `others` around it.
  std::vector<SiteLight> among(const std::vector<Occluder>& others, int rays, const Progress& progress);
  /// The `wanted` sides (all sides if empty) that belong to a body.
  std::vector<std::uint8_t> of_body(std::size_t body, const std::vector<std::uint8_t>& wanted) const;
  /// kept_light() with the cache of the options.
  std::vector<SiteLight> traced(const std::vector<LightSite>& at, const std::vector<std::uint8_t>& wanted,
                                const std::vector<Occluder>& occluders, const Light& in, const Mat3& to_light, int rays,
                                const Progress& progress) const;

 private:
  std::shared_ptr<const BakedObject> object_;
  std::vector<BakedBody> bodies_;
  bool untouched_;
  const LightingOptions& options_;
  std::vector<SiteLight> roughly_;  ///< light as baked, traced with few rays
  std::shared_ptr<const GlossFit> gloss_;
  std::vector<Radiance> shown_colors_;
  std::map<int, std::vector<SiteLight>> of_shown_;  ///< light of the visible sides as baked, by number of rays
  std::map<int, OpenRays> open_;                    ///< visibility of the visible sides, by number of rays
};

/// Light data of all objects of a scene: created on first request, shared by objects that were read from the same
/// files.
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
