#pragma once

#include <array>
#include <cstdint>
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
  std::array<float, 2> open{0, 0};   ///< cosine-weighted share of the half space that nothing hides
  std::array<float, 2> sunny{0, 0};  ///< share of suns that nothing hides, by their irradiance
};

/// By how much two sides are open: the share of the first in what shows, 1, ½ or 0. A side that is as good as closed,
/// or a tenth as open as the other, does not show: the inside of what has one, but for cracks and a missing bottom.
double facing_by_openness(double first, double second);

/// Which of the sites' rays an object lets through, as traced_light sends them: those over both half spaces, then those
/// to each sun. A flag a ray.
class OpenRays {
 public:
  OpenRays(std::size_t sites, int rays, std::size_t suns);
  /// Bytes.
  static std::uint64_t memory_for(std::size_t sites, int rays, std::size_t suns);
  bool at(std::size_t site, std::size_t side, std::size_t ray) const {
    return (words_[word(site, side, ray)] >> ray % 64 & 1) != 0;
  }
  /// Callable from many threads for different sides, whose words are their own.
  void set(std::size_t site, std::size_t side, std::size_t ray) {
    words_[word(site, side, ray)] |= std::uint64_t{1} << ray % 64;
  }
  std::vector<std::uint64_t>& words() { return words_; }

 private:
  std::size_t word(std::size_t site, std::size_t side, std::size_t ray) const {
    return (2 * site + side) * words_a_side_ + ray / 64;
  }
  std::size_t words_a_side_;
  std::vector<std::uint64_t> words_;
};

struct IrradianceOptions {
  int rays = 256;  ///< over each half space; a quarter of that to each sun
  /// Of the same sites, sides, rays and suns among what `around` does not hold.
  const OpenRays* known = nullptr;
  OpenRays* found = nullptr;  ///< to be filled; of none yet
};

/// Traced light at sites among `around`, with directions of their space turned by `to_light` into the light's. Many
/// sites see it along the same lines, even_axes() of the light's space, cosine-weighted (3 to 4 % off at 64 rays over a
/// smooth body): what turned with its light and with all that it sees gets the same, but for rays that pass borders by
/// the rounding of floats. With fewer than 512 rays neighbours take others. Deterministic. `wanted`: of each site 1 for
/// the first side, 2 for the other, 3 for both; empty: both of all.
std::vector<SiteLight> traced_light(std::span<const LightSite> sites, std::span<const std::uint8_t> wanted,
                                    const SceneRays& around, const Light& light, const Mat3& to_light,
                                    const IrradianceOptions& options, const Progress& progress = {});
/// The suns' part of that alone, `rays` to each; nothing of `open`.
std::vector<SiteLight> traced_suns(std::span<const LightSite> sites, std::span<const std::uint8_t> wanted,
                                   const SceneRays& around, const Light& light, const Mat3& to_light, int rays,
                                   const Progress& progress = {});

}  // namespace rebake
