#pragma once

#include <optional>
#include <vector>

#include "mesh_ops/features/fuse_training.h"

namespace rebake {

/// Fits texels within the branches of a side-by-side student: what mixes texels of two branches in a pixel, as where
/// features have come into another branch's sector, shows the colours of neither.
class BranchFit {
 public:
  /// Both must outlive it.
  BranchFit(const Composition& composition, const Student& student);

  /// For each block the branch that its texels are stored in; nothing where they may be in any. Neighbours on the
  /// surface take the same one where that costs them little.
  std::vector<std::optional<std::uint32_t>> choose(const Sightlines& sightlines, std::size_t iterations,
                                                   const Progress& progress) const;
  /// Features of a group as they are stored in a branch, and their error, as NetworkKernels::fit_texels.
  void fit(std::uint32_t branch, const Composition::Part& part, const TexelGroup& group,
           const std::vector<Sighting>& sightings, const TexelFit& how, Lanes* features, Lanes* error,
           Lanes* work) const;

 private:
  void fit_own(std::uint32_t branch, const TexelGroup& group, const std::vector<Sighting>& sightings,
               std::size_t iterations, Lanes* features, Lanes* error, Lanes* work) const;

  const Composition& composition_;
  const Student& student_;
  std::vector<FeatureNetwork> networks_;                 ///< of each branch
  std::vector<std::vector<std::uint32_t>> branches_of_;  ///< of each teacher; rigid ones first
};

}  // namespace rebake
