#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/light/transport/light_sites.h"
#include "mesh_ops/rays/parallel_rays.h"

namespace rebake {

/// Occlusion tests of parallel rays from sides of sites: all sides of a set share the same directions.
class SiteBundles {
 public:
  struct Side {
    std::uint32_t site;
    std::uint8_t side;
    Vec3 normal;  ///< unit, outwards
  };
  /// `wanted`: per site 1 for the first side, 2 for the second, 3 for both; empty for both sides of all sites. Sites
  /// without a normal are skipped. Sites alternate between `sets` direction sets, so that the sampling error is not
  /// constant over a surface. `around` must outlive this object.
  SiteBundles(std::span<const LightSite> sites, std::span<const std::uint8_t> wanted, const SceneRays& around,
              std::size_t sets = 1);

  std::size_t sets() const { return first_.size() - 1; }
  /// All sides, grouped by set.
  const std::vector<Side>& sides() const { return sides_; }
  enum class Ways {
    outwards,  ///< along the direction or its opposite, whichever leads away from the surface
    forward,   ///< along the direction, only if it leads away from the surface
  };
  /// Known visibility: whether a ray may be unoccluded. Null: all may.
  using MayPass = std::function<bool(std::size_t side, std::size_t ray)>;
  /// The results of up to 64 rays of one side: bit k of `passes` is set if ray first + k is unoccluded.
  struct Batch {
    std::size_t first, count;
    std::uint64_t passes;
  };
  /// Visits every side of a set once per batch of rays, in the order of batches, sides in parallel. Reports progress as
  /// `what`, from the share `from` to `to`.
  void send(std::size_t set, std::span<const Vec3> directions, Ways ways, const MayPass& may_pass,
            const Progress& progress, std::string_view what, double from, double to,
            const std::function<void(std::size_t side, const Batch& batch)>& visit) const;

 private:
  static std::vector<Vec3> starts_of(std::span<const LightSite> sites, const std::vector<Side>& sides);

  std::vector<std::size_t> first_;  ///< first side of each set, and the total
  std::vector<Side> sides_;
  ParallelRays rays_;
};

}  // namespace rebake
