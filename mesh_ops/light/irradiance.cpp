#include "mesh_ops/light/irradiance.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "mesh_ops/index/numbering.h"

namespace rebake {

namespace {

using std::numbers::pi;

constexpr double golden = 0.6180339887498949;

struct Spot {
  double x, y;
};

// Fibonacci points of the unit disk: cosine-weighted directions once raised to the half sphere.
std::vector<Spot> disk_points(int count) {
  std::vector<Spot> points;
  for (int k = 0; k < count; ++k) {
    const double r = std::sqrt((k + 0.5) / count), phi = 2 * pi * std::fmod(k * golden, 1.0);
    points.push_back({r * std::cos(phi), r * std::sin(phi)});
  }
  return points;
}

double own_angle(std::size_t site) { return 2 * pi * static_cast<double>(mixed(site, 0x51, 7) >> 11) * 0x1p-53; }

}  // namespace

std::vector<SiteLight> traced_light(std::span<const LightSite> sites, std::span<const std::uint8_t> wanted,
                                    const SceneRays& around, const Light& light, const Mat3& to_light,
                                    const IrradianceOptions& options, const Progress& progress) {
  std::vector<SiteLight> result(sites.size());
  const std::vector<Spot> disk = disk_points(options.rays), sun_disk = disk_points(std::max(4, options.rays / 4));
  const bool sky = !light.sky.black();
  constexpr std::size_t batch = 64;
  const std::size_t batches = (sites.size() + batch - 1) / batch;
  std::atomic<std::size_t> done = 0;
  tbb::parallel_for(std::size_t{0}, batches, [&](std::size_t b) {
    progress.at("tracing light", static_cast<double>(done++) / static_cast<double>(batches));
    for (std::size_t i = b * batch; i < std::min(sites.size(), (b + 1) * batch); ++i) {
      const LightSite& site = sites[i];
      if ((!wanted.empty() && wanted[i] == 0) || !(site.normal.squaredNorm() > 0.5)) continue;
      const double turn = own_angle(i), c = std::cos(turn), s = std::sin(turn);
      const Vec3 across = site.normal.cross(site.tangent);
      for (std::size_t side = 0; side < 2; ++side) {
        if (!wanted.empty() && (wanted[i] >> side & 1) == 0) continue;
        const Vec3 normal = side == 0 ? site.normal : Vec3(-site.normal);
        const Vec3 from = site.position + site.offset * normal;
        Radiance sum = Radiance::Zero();
        int open = 0;
        for (const Spot& spot : disk) {
          const double x = c * spot.x - s * spot.y, y = s * spot.x + c * spot.y;
          const Vec3 d = x * site.tangent + y * across + std::sqrt(std::max(0.0, 1 - x * x - y * y)) * normal;
          if (around.shaded(from, d)) {
            sum += light.bounce;
            continue;
          }
          ++open;
          if (sky) sum += light.sky.at(to_light * d);
        }
        result[i].irradiance[side] = sum / options.rays;
        result[i].open[side] = static_cast<float>(open) / static_cast<float>(options.rays);
        for (const Sun& sun : light.suns) {
          const Vec3 towards = to_light.transpose() * sun.direction;
          const double r = std::tan(sun.radius), cosine = normal.dot(towards);
          if (cosine <= -r) continue;
          const Vec3 u = towards.unitOrthogonal(), v = towards.cross(u);
          double share = 0;
          for (const Spot& spot : sun_disk) {
            const Vec3 d = (towards + r * ((c * spot.x - s * spot.y) * u + (s * spot.x + c * spot.y) * v)).normalized();
            const double above = normal.dot(d);
            if (above > 0 && !around.shaded(from, d)) share += above;
          }
          result[i].irradiance[side] += share / static_cast<double>(sun_disk.size()) * sun.irradiance;
        }
      }
    }
  });
  progress.at("tracing light", 1);
  return result;
}

}  // namespace rebake
