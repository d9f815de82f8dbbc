#include "mesh_ops/light/irradiance.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "mesh_ops/light/cosine_rays.h"

namespace rebake {

std::vector<SiteLight> traced_light(std::span<const LightSite> sites, std::span<const std::uint8_t> wanted,
                                    const SceneRays& around, const Light& light, const Mat3& to_light,
                                    const IrradianceOptions& options, const Progress& progress) {
  std::vector<SiteLight> result(sites.size());
  const std::vector<DiskPoint> disk = disk_points(options.rays), sun_disk = disk_points(std::max(4, options.rays / 4));
  const bool sky = !light.sky.black();
  constexpr std::size_t batch = 64;
  const std::size_t batches = (sites.size() + batch - 1) / batch;
  std::atomic<std::size_t> done = 0;
  tbb::parallel_for(std::size_t{0}, batches, [&](std::size_t b) {
    progress.at("tracing light", static_cast<double>(done++) / static_cast<double>(batches));
    for (std::size_t i = b * batch; i < std::min(sites.size(), (b + 1) * batch); ++i) {
      const LightSite& site = sites[i];
      if ((!wanted.empty() && wanted[i] == 0) || !(site.normal.squaredNorm() > 0.5)) continue;
      for (std::size_t side = 0; side < 2; ++side) {
        if (!wanted.empty() && (wanted[i] >> side & 1) == 0) continue;
        const SiteFrame frame(site, i, side == 1);
        const Vec3 &normal = frame.normal(), &from = frame.from();
        Radiance sum = Radiance::Zero();
        int open = 0;
        for (const DiskPoint& point : disk) {
          const Vec3 d = frame.direction(point);
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
          for (const DiskPoint& point : sun_disk) {
            const DiskPoint p = frame.turned(point);
            const Vec3 d = (towards + r * (p.x * u + p.y * v)).normalized();
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
