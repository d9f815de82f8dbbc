#pragma once

#include <optional>
#include <vector>

#include "mesh_ops/features/fuse_training.h"

namespace rebake {

/// Fits texels within the branches of a side-by-side student. A pixel that mixes texels of two branches shows the
/// colours of neither, and so does a texel whose features leave the sector of its branch.
class BranchFit {
 public:
  /// Both must outlive this object.
  BranchFit(const Composition& composition, const Student& student);

  /// Per block: the branch that stores its texels; nothing if any may. Neighbours on the surface get the same branch if
  /// that costs little.
  std::vector<std::optional<std::uint32_t>> choose(const Sightlines& sightlines, std::size_t iterations,
                                                   const Progress& progress) const;
  /// Fits the features of a group in a branch; results as NetworkKernels::fit_texels().
  void fit(std::uint32_t branch, const Composition::Part& part, const TexelGroup& group,
           const std::vector<Sighting>& sightings, const TexelFit& how, Lanes* features, Lanes* error,
           Lanes* work) const;

 private:
  void fit_own(std::uint32_t branch, const TexelGroup& group, const std::vector<Sighting>& sightings,
               std::size_t iterations, Lanes* features, Lanes* error, Lanes* work) const;

  const Composition& composition_;
  const Student& student_;
  std::vector<FeatureNetwork> networks_;                 ///< per branch
  std::vector<std::vector<std::uint32_t>> branches_of_;  ///< per teacher; rigid branches first
};

}  // namespace rebake
