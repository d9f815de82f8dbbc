#pragma once

#include <array>
#include <memory>
#include <vector>

#include "mesh_ops/light/transport/irradiance.h"
#include "mesh_ops/light/transport/spherical_harmonics.h"

namespace rebake {

/// Environment light for specular reflection: the sky as spherical harmonics, suns as Phong lobes.
struct Gloss {
  std::array<sh::Coefficients, 3> sky{sh::Coefficients::Zero(), sh::Coefficients::Zero(), sh::Coefficients::Zero()};
  std::vector<Sun> suns;
  double sharpness = 0;  ///< exponent of the suns' lobes (Phong 1975)
  /// Maximum number of suns in shaders; the strongest are used.
  static constexpr std::size_t max_suns = 4;
};

/// The environment of a light, with sharpness 0.
Gloss gloss_environment(const Light& light);
/// Linear radiance reflected by a surface with unit `normal` (either side) towards an eye that looks along the unit
/// `direction`. Schlick's Fresnel factor (1994) for a dielectric of index 1.5, scaled by `sky` and `suns`: 1 is smooth
/// glass under an open sky.
Radiance mirrored(const Gloss& gloss, const Vec3& direction, const Vec3& normal, double sky, double suns);

/// Specular amounts of sites, fitted to view-dependent colours.
struct GlossFit {
  Gloss gloss;
  std::vector<Eigen::Vector2f> amounts;  ///< per site: specular amounts for the sky and for suns, without occlusion
  double explained = 0;                  ///< explained share of the view dependence of colours, 0 … 1
  bool any() const { return explained > 0; }
};

/// Fits non-negative amounts per chromaticity cluster, and one sharpness for all, by least squares to the change of
/// decoded colours over unoccluded view directions (`body` occludes). `colors`: per site; `baked`: light on the sites,
/// in their space. The fit is empty if it explains less than a tenth of the change. Deterministic.
GlossFit fitted_gloss(const BakedObject& object, const std::vector<std::shared_ptr<const LightChart>>& charts,
                      const LightSites& sites, const std::vector<float>& facing, const std::vector<Radiance>& colors,
                      const Light& light, const std::vector<SiteLight>& baked, const SceneRays& body);

/// Visibility at a site: shares of the sky and of suns, 0 … 1.
using SiteVisibility = Eigen::Vector2f;
/// Visibility at the visible surface of a site; `facing`: facing_of().
SiteVisibility surface_visibility(const SiteLight& lit, float facing);

/// Change of the specular reflection of a texture set: normal and amounts per chart texel, as baked and as edited.
struct GlossMap {
  std::shared_ptr<const Gloss> gloss;
  struct Side {
    std::vector<Eigen::Vector4f> normals;  ///< xyz: normal of any length, in object space; w: amount of the sky
    std::vector<float> suns;               ///< amounts of suns
  };
  Side before, after;
};

/// The map of a chart whose first site is `first`; null if no reflection changes.
std::shared_ptr<const GlossMap> gloss_map(const LightChart& chart, const LightSites& sites,
                                          const std::vector<LightSite>& now, std::size_t first,
                                          const std::shared_ptr<const GlossFit>& fit,
                                          const std::vector<SiteVisibility>& before,
                                          const std::vector<SiteVisibility>& after);

/// Specular reflection at one point of a GlossMap: normals with sky amounts, and sun amounts, as baked and as edited.
struct GlossPlace {
  Eigen::Vector4f before = Eigen::Vector4f::Zero(), after = Eigen::Vector4f::Zero();
  float suns_before = 0, suns_after = 0;
};
/// Radiance to add to a linear colour after it was multiplied by `gain`: the reflection as edited, minus `gain` times
/// the reflection as baked. `now`: unit view direction; `baked`: the same relative to the surface as baked.
Radiance gloss_change(const Gloss& gloss, const GlossPlace& place, const Radiance& gain, const Vec3& baked,
                      const Vec3& now);

}  // namespace rebake
