#pragma once

#include <array>
#include <memory>
#include <vector>

#include "mesh_ops/light/irradiance.h"
#include "mesh_ops/light/spherical_harmonics.h"

namespace rebake {

/// How surfaces mirror the light that they stand in: the sky as a few spherical harmonics, suns as lobes.
struct Gloss {
  std::array<sh::Coefficients, 3> sky{sh::Coefficients::Zero(), sh::Coefficients::Zero(), sh::Coefficients::Zero()};
  std::vector<Sun> suns;
  double sharpness = 0;  ///< exponent of suns' lobes (Phong 1975)
  /// The suns that are followed, the strongest first: shaders have room for so many.
  static constexpr std::size_t most_suns = 4;
};

/// A light ready to be mirrored, by nothing yet said how sharply.
Gloss mirrored_light(const Light& light);
/// Linear radiance that a surface of normal `normal` (either side) mirrors towards an eye that looks along `direction`,
/// both of length 1. Fresnel's factor by Schlick (1994), of a dielectric of index 1.5; `sky` and `suns` scale it: 1 is
/// smooth glass under an open sky.
Radiance mirrored(const Gloss& gloss, const Vec3& direction, const Vec3& normal, double sky, double suns);

/// How much sites mirror, as colours tell.
struct GlossFit {
  Gloss gloss;
  std::vector<Eigen::Vector2f> amounts;  ///< a site: of the sky and of suns, where neither is hidden
  double explained = 0;                  ///< share of how colours change with the eye that it accounts for, 0 … 1
  bool any() const { return explained > 0; }
};

/// Non-negative amounts for each chromaticity, by least squares over how decoded colours of some sites change with the
/// eye, from where nothing of `body` hides them, and one sharpness for all. `colors` and `baked`: of the sites, what
/// they look like and what reached them, in a light whose directions are theirs. Nothing is mirrored where that
/// accounts for less than a tenth of the change. Deterministic.
GlossFit found_gloss(const BakedObject& object, const std::vector<std::shared_ptr<const LightChart>>& charts,
                     const LightSites& sites, const std::vector<float>& facing, const std::vector<Radiance>& colors,
                     const Light& light, const std::vector<SiteLight>& baked, const SceneRays& body);

/// What is open over a site: shares of the sky and of suns.
using Openness = Eigen::Vector2f;
Openness shown_openness(const SiteLight& lit, float facing);

/// What changes of the light that a texture set mirrors: of each texel of its chart the surface's normal and what is
/// mirrored there, as it was baked and as it is.
struct GlossMap {
  std::shared_ptr<const Gloss> gloss;
  struct Side {
    std::vector<Eigen::Vector4f> normals;  ///< of any length, in the object's space; then the amount of the sky
    std::vector<float> suns;               ///< amounts
  };
  Side before, after;
};

/// The map of a chart whose first site is `first`; null where nothing mirrors otherwise than it was baked.
std::shared_ptr<const GlossMap> gloss_map(const LightChart& chart, const LightSites& sites,
                                          const std::vector<LightSite>& now, std::size_t first,
                                          const std::shared_ptr<const GlossFit>& fit,
                                          const std::vector<Openness>& before, const std::vector<Openness>& after);

/// Of one place of a map: what is added to linear colours along a direction, where their light is multiplied by `gain`.
/// `baked` is the direction as the surface saw it when it was baked.
struct GlossPlace {
  Eigen::Vector4f before = Eigen::Vector4f::Zero(), after = Eigen::Vector4f::Zero();
  float suns_before = 0, suns_after = 0;
};
Radiance gloss_change(const Gloss& gloss, const GlossPlace& place, const Radiance& gain, const Vec3& baked,
                      const Vec3& now);

}  // namespace rebake
