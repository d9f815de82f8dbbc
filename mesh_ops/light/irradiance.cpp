#include "mesh_ops/light/irradiance.h"

#include <algorithm>
#include <cmath>

#include "mesh_ops/light/site_rays.h"

namespace rebake {

double facing_by_openness(double first, double second) {
  constexpr double closed = 0.03, much = 0.1;
  const double least = std::max(closed, much * std::max(first, second));
  return (first > least) == (second > least) ? 0.5 : first > least ? 1 : 0;
}

namespace {

std::size_t rays_to_sun(int rays) { return static_cast<std::size_t>(std::max(4, rays / 4)); }

// What a site sees of a sun; `open(ray, direction)` says whether nothing hides it.
struct Sunlight {
  Radiance irradiance = Radiance::Zero();  // over π
  double share = 0;                        // of its disk
};
template <class Open>
Sunlight sunlight(const SiteFrame& frame, const Sun& sun, const Vec3& towards, const std::vector<DiskPoint>& disk,
                  Open open) {
  const double r = std::tan(sun.radius);
  if (frame.normal().dot(towards) <= -r) return {};
  const Vec3 u = towards.unitOrthogonal(), v = towards.cross(u);
  double cosines = 0;
  int seen = 0;
  for (std::size_t k = 0; k < disk.size(); ++k) {
    const DiskPoint p = frame.turned(disk[k]);
    const Vec3 d = (towards + r * (p.x * u + p.y * v)).normalized();
    const double above = frame.normal().dot(d);
    if (!(above > 0) || !open(k, d)) continue;
    cosines += above;
    ++seen;
  }
  const auto count = static_cast<double>(disk.size());
  return {cosines / count * sun.irradiance, seen / count};
}

// Adds what a side of a site sees of some suns.
template <class Open>
void add_suns(SiteLight& lit, std::size_t side, const SiteFrame& frame, const Light& light, const Mat3& to_light,
              const std::vector<DiskPoint>& disk, Open open) {
  double all = 0, seen = 0;
  for (std::size_t s = 0; s < light.suns.size(); ++s) {
    const Sun& sun = light.suns[s];
    const Sunlight found = sunlight(frame, sun, to_light.transpose() * sun.direction, disk,
                                    [&](std::size_t ray, const Vec3& d) { return open(s, ray, d); });
    lit.irradiance[side] += found.irradiance;
    all += sun.irradiance.sum();
    seen += found.share * sun.irradiance.sum();
  }
  if (all > 0) lit.sunny[side] = static_cast<float>(seen / all);
}

}  // namespace

static std::size_t words_of_side(int rays, std::size_t suns) {
  return (static_cast<std::size_t>(rays) + suns * rays_to_sun(rays) + 63) / 64;
}
OpenRays::OpenRays(std::size_t sites, int rays, std::size_t suns)
    : words_a_side_(words_of_side(rays, suns)), words_(2 * sites * words_a_side_, 0) {}
std::uint64_t OpenRays::memory_for(std::size_t sites, int rays, std::size_t suns) {
  return std::uint64_t{2} * sites * words_of_side(rays, suns) * sizeof(std::uint64_t);
}

std::vector<SiteLight> traced_light(std::span<const LightSite> sites, std::span<const std::uint8_t> wanted,
                                    const SceneRays& around, const Light& light, const Mat3& to_light,
                                    const IrradianceOptions& options, const Progress& progress) {
  std::vector<SiteLight> result(sites.size());
  const std::vector<DiskPoint> disk = disk_points(options.rays),
                               sun_disk = disk_points(static_cast<int>(rays_to_sun(options.rays)));
  const bool sky = !light.sky.black();
  for_each_site(sites.size(), progress, "tracing light", 0, 1, [&](std::size_t i) {
    const LightSite& site = sites[i];
    if ((!wanted.empty() && wanted[i] == 0) || !(site.normal.squaredNorm() > 0.5)) return;
    for (std::size_t side = 0; side < 2; ++side) {
      if (!wanted.empty() && (wanted[i] >> side & 1) == 0) continue;
      const SiteFrame frame(site, i, side == 1);
      const Vec3& from = frame.from();
      const auto passes = [&](std::size_t ray, const Vec3& d) {
        if ((options.known != nullptr && !options.known->at(i, side, ray)) || around.shaded(from, d)) return false;
        if (options.found != nullptr) options.found->set(i, side, ray);
        return true;
      };
      Radiance sum = Radiance::Zero();
      int open = 0;
      for (std::size_t k = 0; k < disk.size(); ++k) {
        const Vec3 d = frame.direction(disk[k]);
        if (!passes(k, d)) {
          sum += light.bounce;
          continue;
        }
        ++open;
        if (sky) sum += light.sky.at(to_light * d);
      }
      result[i].irradiance[side] = sum / options.rays;
      result[i].open[side] = static_cast<float>(open) / static_cast<float>(options.rays);
      add_suns(result[i], side, frame, light, to_light, sun_disk, [&](std::size_t sun, std::size_t ray, const Vec3& d) {
        return passes(disk.size() + sun * sun_disk.size() + ray, d);
      });
    }
  });
  return result;
}

std::vector<SiteLight> traced_suns(std::span<const LightSite> sites, std::span<const std::uint8_t> wanted,
                                   const SceneRays& around, const Light& light, const Mat3& to_light, int rays,
                                   const Progress& progress) {
  std::vector<SiteLight> result(sites.size());
  if (light.suns.empty()) return result;
  const std::vector<DiskPoint> disk = disk_points(rays);
  for_each_site(sites.size(), progress, "tracing suns", 0, 1, [&](std::size_t i) {
    if (!(sites[i].normal.squaredNorm() > 0.5)) return;
    for (std::size_t side = 0; side < 2; ++side) {
      if (!wanted.empty() && (wanted[i] >> side & 1) == 0) continue;
      const SiteFrame frame(sites[i], i, side == 1);
      add_suns(result[i], side, frame, light, to_light, disk,
               [&](std::size_t, std::size_t, const Vec3& d) { return !around.shaded(frame.from(), d); });
    }
  });
  return result;
}

}  // namespace rebake
