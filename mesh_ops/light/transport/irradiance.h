#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/light/transport/light_sites.h"
#include "mesh_ops/rays/scene_rays.h"
#include "mesh_ops/scene/scene_light.h"

namespace rebake {

/// Light on the two sides of a site; [0] is the side that the normal points to.
struct SiteLight {
  std::array<Radiance, 2> irradiance{Radiance(0, 0, 0), Radiance(0, 0, 0)};  ///< per side: irradiance / π, linear
  std::array<float, 2> open{0, 0};            ///< per side: cosine-weighted visibility of the half space, 0 … 1
  std::array<float, 2> sun_visibility{0, 0};  ///< per side: visible share of the suns' irradiance, 0 … 1
};

/// Share of the first side in the visible surface (1, ½ or 0), from the visibility of both sides. A side counts as
/// hidden if its visibility is below 0.03 or below a tenth of the other's. Such a side is the inside of a body that has
/// cracks or no bottom.
double facing_by_visibility(double first, double second);

/// Visibility flags of rays from sites past one object: one bit per ray, in the order of traced_light(). Per side first
/// the rays over the half space, then those to each sun.
class VisibilityFlags {
 public:
  VisibilityFlags(std::size_t sites, int rays, std::size_t suns);
  /// Memory in bytes.
  static std::uint64_t memory_for(std::size_t sites, int rays, std::size_t suns);
  bool at(std::size_t site, std::size_t side, std::size_t ray) const {
    return (words_[word(site, side, ray)] >> ray % 64 & 1) != 0;
  }
  /// Thread-safe for different sides, which own separate words.
  void set(std::size_t site, std::size_t side, std::size_t ray) {
    words_[word(site, side, ray)] |= std::uint64_t{1} << ray % 64;
  }
  std::vector<std::uint64_t>& words() { return words_; }

 private:
  std::size_t word(std::size_t site, std::size_t side, std::size_t ray) const {
    return (2 * site + side) * words_per_side_ + ray / 64;
  }
  std::size_t words_per_side_;
  std::vector<std::uint64_t> words_;
};

struct IrradianceOptions {
  int rays = 256;  ///< per half space; a quarter of it, at least 4, per sun
  /// Visibility of the same rays past occluders that `around` does not contain.
  const VisibilityFlags* known = nullptr;
  VisibilityFlags* found = nullptr;  ///< receives the visibility; no flag may be set yet
};

/// Traces light at sites among `around`; `to_light` rotates directions from their space into the light's. Sites share
/// the directions even_axes() of the light's space, cosine-weighted (error of 3 to 4 % at 64 rays on a smooth body). So
/// a scene that is rotated together with its light gets the same result, except for rays that pass edges within float
/// rounding. With fewer than 512 rays, neighbouring sites use different direction sets. Deterministic. `wanted`: per
/// site 1 for the first side, 2 for the second, 3 for both; empty for both sides of all sites.
std::vector<SiteLight> traced_light(std::span<const LightSite> sites, std::span<const std::uint8_t> wanted,
                                    const SceneRays& around, const Light& light, const Mat3& to_light,
                                    const IrradianceOptions& options, const Progress& progress = {});
/// The suns' part only, with `rays` rays per sun; `open` stays 0.
std::vector<SiteLight> traced_suns(std::span<const LightSite> sites, std::span<const std::uint8_t> wanted,
                                   const SceneRays& around, const Light& light, const Mat3& to_light, int rays,
                                   const Progress& progress = {});

}  // namespace rebake
