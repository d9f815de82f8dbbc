#include "mesh_ops/light/transfer.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "mesh_ops/light/site_rays.h"

namespace rebake {

double relative_difference(const std::vector<sh::Coefficients>& transfer, const std::vector<sh::Coefficients>& truth) {
  double off = 0, all = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    off += (transfer[i] - truth[i]).squaredNorm();
    all += truth[i].squaredNorm();
  }
  return all > 0 ? std::sqrt(off / all) : 0;
}

Transfer traced_transfer(std::span<const LightSite> sites, const SceneRays& around, int rays,
                         const Progress& progress) {
  Transfer result;
  result.sites.assign(sites.size(), sh::Coefficients::Zero());
  std::vector<sh::Coefficients> half = result.sites;
  const std::vector<DiskPoint> disk = disk_points(rays);
  for_each_site(sites.size(), progress, "tracing transfer", 0, 1, [&](std::size_t i) {
    if (!(sites[i].normal.squaredNorm() > 0.5)) return;
    const SiteFrame frame(sites[i], i);
    for (std::size_t k = 0; k < disk.size(); ++k) {
      const Vec3 d = frame.direction(disk[k]);
      if (around.shaded(frame.from(), d)) continue;
      const sh::Coefficients one = sh::basis(d);
      result.sites[i] += one;
      if (k % 2 == 0) half[i] += one;
    }
    result.sites[i] /= rays;
    half[i] *= 2.0 / rays;
  });
  // The halves' difference is twice what the whole is off by, where errors are independent.
  result.relative_error = relative_difference(half, result.sites);
  return result;
}

Transfer turned_transfer(const Transfer& transfer, std::span<const Mat3> turns) {
  Transfer result = transfer;
  tbb::parallel_for(std::size_t{0}, result.sites.size(), [&](std::size_t i) {
    if (!turns[i].isIdentity(0)) result.sites[i] = sh::Rotation(turns[i]) * transfer.sites[i];
  });
  return result;
}

}  // namespace rebake
