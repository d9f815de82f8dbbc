#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/light/light_sites.h"
#include "mesh_ops/rays/parallel_rays.h"

namespace rebake {

/// Rays from sides of sites, of which many take the same directions.
class SiteBundles {
 public:
  struct Side {
    std::uint32_t site;
    std::uint8_t side;
    Vec3 normal;  ///< outwards
  };
  /// `wanted`: of each site 1 for the first side, 2 for the other, 3 for both; empty: both of all. Sites without a
  /// normal have none. Sites take turns in so many `sets`, whose directions may differ: what directions are off by is
  /// the same for all of a part where they are the same. `around` must outlive it.
  SiteBundles(std::span<const LightSite> sites, std::span<const std::uint8_t> wanted, const SceneRays& around,
              std::size_t sets = 1);

  std::size_t sets() const { return first_.size() - 1; }
  /// Set by set.
  const std::vector<Side>& sides() const { return sides_; }
  enum class Ways {
    outwards,  ///< along a direction or against it, as leads away from the surface
    forward,   ///< along a direction, where that leads away from the surface
  };
  /// Whether a ray may pass, as far as is known; null: any may.
  using MayPass = std::function<bool(std::size_t side, std::size_t ray)>;
  /// `passes`: of `count` rays from number `first` on, a bit each; those that nothing hides.
  struct Batch {
    std::size_t first, count;
    std::uint64_t passes;
  };
  /// Visits every side of a set once for each batch of rays, batch by batch in their order, many sides at once; `what`
  /// is being done, from one share of it to another.
  void send(std::size_t set, std::span<const Vec3> directions, Ways ways, const MayPass& may_pass,
            const Progress& progress, std::string_view what, double from, double to,
            const std::function<void(std::size_t side, const Batch& batch)>& visit) const;

 private:
  static std::vector<Vec3> starts_of(std::span<const LightSite> sites, const std::vector<Side>& sides);

  std::vector<std::size_t> first_;  ///< of each set's sides, and the end
  std::vector<Side> sides_;
  ParallelRays rays_;
};

}  // namespace rebake
