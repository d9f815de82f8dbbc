#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string_view>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/index/numbering.h"
#include "mesh_ops/light/transport/light_sites.h"

namespace rebake {

/// A point of the unit disk. Projected onto the half sphere, even points are cosine-weighted directions.
struct DiskPoint {
  double x, y;
};

/// Fibonacci points of the unit disk.
inline std::vector<DiskPoint> disk_points(int count) {
  constexpr double golden = 0.6180339887498949;
  std::vector<DiskPoint> points;
  for (int k = 0; k < count; ++k) {
    const double r = std::sqrt((k + 0.5) / count), phi = 2 * std::numbers::pi * std::fmod(k * golden, 1.0);
    points.push_back({r * std::cos(phi), r * std::sin(phi)});
  }
  return points;
}

/// Rotation angle of the sample points of a site or set, pseudo-random, so that errors of neighbours differ.
inline double sample_rotation(std::size_t number) {
  return 2 * std::numbers::pi * static_cast<double>(mixed(number, 0x51, 7) >> 11) * 0x1p-53;
}

/// Local frame over one side of a site, aligned with its tangent.
class SiteFrame {
 public:
  SiteFrame(const LightSite& site, std::size_t number, bool back = false)
      : normal_(back ? Vec3(-site.normal) : site.normal),
        tangent_(site.tangent),
        across_(site.normal.cross(site.tangent)),
        from_(site.position + site.offset[back ? 1 : 0] * normal_),
        cosine_(std::cos(sample_rotation(number))),
        sine_(std::sin(sample_rotation(number))) {}

  const Vec3& normal() const { return normal_; }
  /// Origin of rays.
  const Vec3& from() const { return from_; }
  /// A sample point, rotated by sample_rotation().
  DiskPoint turned(const DiskPoint& p) const { return {cosine_ * p.x - sine_ * p.y, sine_ * p.x + cosine_ * p.y}; }
  /// The unit direction above a point of the disk.
  Vec3 direction(const DiskPoint& point) const {
    const DiskPoint p = turned(point);
    return p.x * tangent_ + p.y * across_ + std::sqrt(std::max(0.0, 1 - p.x * p.x - p.y * p.y)) * normal_;
  }

 private:
  Vec3 normal_, tangent_, across_, from_;
  double cosine_, sine_;
};

/// Even directions over a half sphere: a Fibonacci lattice (Hannay and Nye 2004) in general position to the axes,
/// rotated differently for each `set`. Together with their opposites, every half sphere contains about `count`.
inline std::vector<Vec3> even_axes(int count, std::size_t set = 0) {
  constexpr double golden = 0.6180339887498949;
  Eigen::Quaterniond turn = Eigen::Quaterniond(0.82, 0.31, -0.39, 0.28).normalized();
  if (set > 0) {
    // Uniform random rotation (Shoemake 1992).
    const auto share = [&](std::uint64_t part) { return static_cast<double>(mixed(set, 0x53, part) >> 11) * 0x1p-53; };
    const double u = share(0), a = 2 * std::numbers::pi * share(1), b = 2 * std::numbers::pi * share(2);
    turn = Eigen::Quaterniond(std::sqrt(u) * std::cos(b), std::sqrt(1 - u) * std::sin(a),
                              std::sqrt(1 - u) * std::cos(a), std::sqrt(u) * std::sin(b));
  }
  std::vector<Vec3> axes;
  for (int k = 0; k < count; ++k) {
    const double z = (k + 0.5) / count, r = std::sqrt(1 - z * z),
                 phi = 2 * std::numbers::pi * std::fmod(k * golden, 1.0);
    axes.push_back(turn * Vec3(r * std::cos(phi), r * std::sin(phi), z));
  }
  return axes;
}

/// Calls visit(i) for all i < count in parallel. Reports progress as `what`, from the share `from` to `to`.
template <class Visit>
void for_each_site(std::size_t count, const Progress& progress, std::string_view what, double from, double to,
                   Visit visit) {
  constexpr std::size_t batch = 64;
  const std::size_t batches = (count + batch - 1) / batch;
  std::atomic<std::size_t> done = 0;
  tbb::parallel_for(std::size_t{0}, batches, [&](std::size_t b) {
    progress.at(what, from + (to - from) * static_cast<double>(done++) / static_cast<double>(batches));
    for (std::size_t i = b * batch; i < std::min(count, (b + 1) * batch); ++i) visit(i);
  });
  progress.at(what, to);
}

}  // namespace rebake
