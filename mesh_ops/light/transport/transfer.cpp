#include "mesh_ops/light/transport/transfer.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>

#include "mesh_ops/light/transport/site_bundles.h"
#include "mesh_ops/light/transport/site_rays.h"

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
  const std::vector<Vec3> axes = even_axes(rays);
  // Basis functions along and against each axis. The up to 64 rays of a batch are summed in floats.
  using Floats = Eigen::Matrix<float, sh::count, 1>;
  std::vector<std::array<Floats, 2>> bases;
  for (const Vec3& axis : axes) bases.push_back({sh::basis(axis).cast<float>(), sh::basis(-axis).cast<float>()});
  const std::vector<std::uint8_t> first_sides(sites.size(), 1);
  const SiteBundles bundles(sites, first_sides, around);
  // One direction set for all sites: at 64 rays, the error that more sets would remove is not worth their time.
  std::vector<std::array<double, 2>> cosines(bundles.sides().size(), {0, 0});  // sums per side: odd rays, even rays
  bundles.send(0, axes, SiteBundles::Ways::outwards, {}, progress, "tracing transfer", 0, 1,
               [&](std::size_t i, const SiteBundles::Batch& batch) {
                 const auto& [site, side, normal] = bundles.sides()[i];
                 std::array<Floats, 2> sums{Floats::Zero(), Floats::Zero()};  // over odd and over even rays
                 for (std::size_t k = 0; k < batch.count; ++k) {
                   const std::size_t ray = batch.first + k, even = ray % 2 == 0 ? 1 : 0;
                   const double above = normal.dot(axes[ray]), cosine = std::abs(above);
                   cosines[i][even] += cosine;
                   const double seen = (batch.passes >> k & 1) != 0 ? cosine : 0;
                   sums[even] += static_cast<float>(seen) * bases[ray][above > 0 ? 0 : 1];
                 }
                 result.sites[site] += sums[0].cast<double>();
                 half[site] += sums[1].cast<double>();
               });
  for (std::size_t i = 0; i < cosines.size(); ++i) {
    const auto& [odd, even] = cosines[i];
    const std::uint32_t site = bundles.sides()[i].site;
    if (!(even > 0)) continue;
    result.sites[site] = (result.sites[site] + half[site]) / (odd + even);
    half[site] /= even;
  }
  // The error of a lattice of n points falls as n^−¾, like its discrepancy (Brauchart and Dick 2012).
  result.relative_error = std::pow(2, -0.75) * relative_difference(half, result.sites);
  return result;
}

Transfer rotated_transfer(const Transfer& transfer, std::span<const Mat3> turns) {
  Transfer result = transfer;
  tbb::parallel_for(std::size_t{0}, result.sites.size(), [&](std::size_t i) {
    if (!turns[i].isIdentity(0)) result.sites[i] = sh::Rotation(turns[i]) * transfer.sites[i];
  });
  return result;
}

}  // namespace rebake
