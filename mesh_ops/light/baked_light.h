#pragma once

#include <map>
#include <memory>
#include <vector>

#include "mesh_ops/light/gloss.h"
#include "mesh_ops/light/kept_light.h"
#include "mesh_ops/light/lighting.h"

namespace rebake {

/// What an object's light says of it wherever the object stands: its sites, their colours, and the light that it was
/// baked in. Nodes that show one object share it.
class BakedLight {
 public:
  /// Options must outlive it.
  BakedLight(std::shared_ptr<const BakedObject> object, const SceneLight& settings, const LightingOptions& options,
             const Progress& progress);

  std::vector<std::shared_ptr<const LightChart>> charts;
  LightSites sites;
  std::vector<Radiance> colors;  ///< seen from both sides alike
  std::vector<float> facing;
  std::vector<std::uint8_t> sides;  ///< that show, as traced_light wants them
  std::shared_ptr<const Light> light;
  double confidence = 0;     ///< in it, where it was found
  Radiance albedo{1, 1, 1};  ///< that nine sites of ten stay below

  /// What it mirrors; of objects of one body that has not been turned.
  const std::shared_ptr<const GlossFit>& gloss();
  bool may_mirror() const { return bodies_.size() == 1 && bodies_.front().to_object.matrix().isIdentity(0); }
  /// Colours of what shows.
  const std::vector<Radiance>& shown_colors();
  /// What light fell on the sites of some sides as they were baked, whole; all sides where `wanted` is empty.
  std::vector<SiteLight> as_baked(const std::vector<std::uint8_t>& wanted, int rays, const Progress& progress);
  const std::shared_ptr<const BakedObject>& object() const { return object_; }
  /// Whether it is as its light was baked.
  bool untouched() const { return untouched_; }
  /// What falls on what shows of an untouched object, among others that stand around it.
  std::vector<SiteLight> among(const std::vector<Occluder>& others, int rays, const Progress& progress);
  /// The sides of `wanted` (of all, where it is empty) that belong to a body.
  std::vector<std::uint8_t> of_body(std::size_t body, const std::vector<std::uint8_t>& wanted) const;
  /// kept_light(), kept if the options say so.
  std::vector<SiteLight> traced(const std::vector<LightSite>& at, const std::vector<std::uint8_t>& wanted,
                                const std::vector<Occluder>& occluders, const Light& in, const Mat3& to_light, int rays,
                                const Progress& progress) const;

 private:
  std::shared_ptr<const BakedObject> object_;
  std::vector<BakedBody> bodies_;
  bool untouched_;
  const LightingOptions& options_;
  std::vector<SiteLight> roughly_;  ///< as baked, by few rays
  std::shared_ptr<const GlossFit> gloss_;
  std::vector<Radiance> shown_colors_;
  std::map<int, std::vector<SiteLight>> of_shown_;  ///< as baked, by rays
  std::map<int, OpenRays> open_;                    ///< of what shows, by rays
};

/// Of all objects of a scene, each made when it is first asked for, once for all that were read from the same files.
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
