#include "mesh_ops/light/transport/irradiance.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "mesh_ops/light/transport/site_bundles.h"
#include "mesh_ops/light/transport/site_rays.h"

namespace rebake {

double facing_by_visibility(double first, double second) {
  constexpr double closed = 0.03, much = 0.1;
  const double least = std::max(closed, much * std::max(first, second));
  return (first > least) == (second > least) ? 0.5 : first > least ? 1 : 0;
}

namespace {

std::size_t rays_to_sun(int rays) { return static_cast<std::size_t>(std::max(4, rays / 4)); }

SiteBundles::MayPass may_pass(const SiteBundles& bundles, const VisibilityFlags* known, std::size_t first_ray) {
  if (known == nullptr) return {};
  return [&bundles, known, first_ray](std::size_t side, std::size_t ray) {
    const SiteBundles::Side& one = bundles.sides()[side];
    return known->at(one.site, one.side, first_ray + ray);
  };
}

// Number of direction sets. Together they have about 512 directions, so that their common error is small over a part of
// a surface; each set has at least 32 sites.
std::size_t sets_for(int rays, std::size_t sites) {
  constexpr std::size_t enough = 512, min_sites = 32;
  return std::clamp<std::size_t>(enough / static_cast<std::size_t>(std::max(1, rays)), 1,
                                 std::max<std::size_t>(1, sites / min_sites));
}

// Directions to points of a sun's disk, in the sites' space.
std::vector<Vec3> sun_directions(const Sun& sun, const Mat3& to_light, const std::vector<DiskPoint>& disk,
                                 std::size_t set) {
  const double r = std::tan(sun.radius), cosine = std::cos(sample_rotation(set)), sine = std::sin(sample_rotation(set));
  const Vec3 u = sun.direction.unitOrthogonal(), v = sun.direction.cross(u);
  std::vector<Vec3> directions;
  for (const DiskPoint& p : disk) {
    const Vec3 aside = (cosine * p.x - sine * p.y) * u + (sine * p.x + cosine * p.y) * v;
    directions.push_back(to_light.transpose() * (sun.direction + r * aside).normalized());
  }
  return directions;
}

// Adds irradiance by the suns to `lit`, and sets the suns' visibility. `known` and `found` may be null; their flags for
// suns start at ray `first_ray`.
void add_suns(std::vector<SiteLight>& lit, const SiteBundles& bundles, const Light& light, const Mat3& to_light,
              const std::vector<DiskPoint>& disk, const VisibilityFlags* known, VisibilityFlags* found,
              std::size_t first_ray, const Progress& progress, double from) {
  double all = 0;
  for (const Sun& sun : light.suns) all += sun.irradiance.sum();
  const auto count = static_cast<double>(disk.size());
  const double step = (1 - from) / static_cast<double>(light.suns.size());
  std::vector<double> seen(bundles.sides().size(), 0);  // per side: visible irradiance, summed over suns and channels
  for (std::size_t s = 0; s < light.suns.size(); ++s) {
    const Sun& sun = light.suns[s];
    const std::size_t offset = first_ray + s * disk.size();
    // A sun has few rays per set, so the sets run in parallel too.
    tbb::parallel_for(std::size_t{0}, bundles.sets(), [&](std::size_t set) {
      const std::vector<Vec3> directions = sun_directions(sun, to_light, disk, set);
      bundles.send(set, directions, SiteBundles::Ways::forward, may_pass(bundles, known, offset), progress,
                   "tracing light", from + step * static_cast<double>(s), from + step * static_cast<double>(s),
                   [&](std::size_t i, const SiteBundles::Batch& batch) {
                     const auto& [site, side, normal] = bundles.sides()[i];
                     double cosines = 0;
                     for (std::uint64_t left = batch.passes; left != 0; left &= left - 1) {
                       const std::size_t ray = batch.first + static_cast<std::size_t>(std::countr_zero(left));
                       cosines += normal.dot(directions[ray]);
                       if (found != nullptr) found->set(site, side, offset + ray);
                     }
                     lit[site].irradiance[side] += cosines / count * sun.irradiance;
                     seen[i] += std::popcount(batch.passes) / count * sun.irradiance.sum();
                   });
    });
  }
  if (!(all > 0)) return;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto& [site, side, normal] = bundles.sides()[i];
    lit[site].sun_visibility[side] = static_cast<float>(seen[i] / all);
  }
}

}  // namespace

static std::size_t words_of_side(int rays, std::size_t suns) {
  return (static_cast<std::size_t>(rays) + suns * rays_to_sun(rays) + 63) / 64;
}
VisibilityFlags::VisibilityFlags(std::size_t sites, int rays, std::size_t suns)
    : words_per_side_(words_of_side(rays, suns)), words_(2 * sites * words_per_side_, 0) {}
std::uint64_t VisibilityFlags::memory_for(std::size_t sites, int rays, std::size_t suns) {
  return std::uint64_t{2} * sites * words_of_side(rays, suns) * sizeof(std::uint64_t);
}

std::vector<SiteLight> traced_light(std::span<const LightSite> sites, std::span<const std::uint8_t> wanted,
                                    const SceneRays& around, const Light& light, const Mat3& to_light,
                                    const IrradianceOptions& options, const Progress& progress) {
  std::vector<SiteLight> result(sites.size());
  const SiteBundles bundles(sites, wanted, around, sets_for(options.rays, sites.size()));
  struct Sum {
    Radiance light = Radiance::Zero();
    double open = 0, all = 0;  // sums of cosines: of unoccluded rays, of all rays
  };
  std::vector<Sum> sums(bundles.sides().size());
  const auto rays = static_cast<double>(options.rays),
             sun_rays = static_cast<double>(light.suns.size() * rays_to_sun(options.rays));
  const double share = rays / (rays + sun_rays), step = share / static_cast<double>(bundles.sets());
  for (std::size_t set = 0; set < bundles.sets(); ++set) {
    // Directions are fixed in the light's space, so that an object that rotates with its light gets the same result.
    std::vector<Vec3> axes = even_axes(options.rays, set);
    std::vector<std::array<Radiance, 2>> sky;  // sky radiance along and against each axis
    for (Vec3& axis : axes) {
      sky.push_back({light.sky.at(axis), light.sky.at(-axis)});
      axis = to_light.transpose() * axis;
    }
    bundles.send(set, axes, SiteBundles::Ways::outwards, may_pass(bundles, options.known, 0), progress, "tracing light",
                 step * static_cast<double>(set), step * static_cast<double>(set + 1),
                 [&](std::size_t i, const SiteBundles::Batch& batch) {
                   const auto& [site, side, normal] = bundles.sides()[i];
                   Sum& sum = sums[i];
                   for (std::size_t k = 0; k < batch.count; ++k) {
                     const double above = normal.dot(axes[batch.first + k]), cosine = std::abs(above);
                     sum.all += cosine;
                     if ((batch.passes >> k & 1) == 0) continue;
                     sum.open += cosine;
                     sum.light += cosine * sky[batch.first + k][above > 0 ? 0 : 1];
                     if (options.found != nullptr) options.found->set(site, side, batch.first + k);
                   }
                 });
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const auto& [site, side, normal] = bundles.sides()[i];
    const Sum& sum = sums[i];
    if (!(sum.all > 0)) continue;
    result[site].irradiance[side] = (sum.light + (sum.all - sum.open) * light.bounce) / sum.all;
    result[site].open[side] = static_cast<float>(sum.open / sum.all);
  }
  add_suns(result, bundles, light, to_light, disk_points(static_cast<int>(rays_to_sun(options.rays))), options.known,
           options.found, static_cast<std::size_t>(options.rays), progress, share);
  return result;
}

std::vector<SiteLight> traced_suns(std::span<const LightSite> sites, std::span<const std::uint8_t> wanted,
                                   const SceneRays& around, const Light& light, const Mat3& to_light, int rays,
                                   const Progress& progress) {
  std::vector<SiteLight> result(sites.size());
  if (!light.suns.empty())
    add_suns(result, SiteBundles(sites, wanted, around, sets_for(16 * rays, sites.size())), light, to_light,
             disk_points(rays), nullptr, nullptr, 0, progress, 0);
  return result;
}

}  // namespace rebake
