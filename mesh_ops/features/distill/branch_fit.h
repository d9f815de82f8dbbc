#pragma once

#include <optional>
#include <vector>

#include "mesh_ops/features/distill/fuse_training.h"

namespace rebake {

/// Fits texels within the branches of a side-by-side student. Every texel is stored by one branch, because two things
/// show wrong colours: a pixel that mixes texels of two branches, and a texel whose features leave the sector of its
/// branch.
class BranchFit {
 public:
  /// Both references must outlive this object.
  BranchFit(const Composition& composition, const Student& student);

  /// Chooses a branch per block; nothing if any branch may store its texels. Neighbours on the surface get the same
  /// branch if that costs little. `iterations`: Gauss–Newton iterations per trial.
  std::vector<std::optional<std::uint32_t>> choose(const VisibleDirections& sightlines, std::size_t iterations,
                                                   const Progress& progress) const;
  /// Fits the features of a group to its observations within a branch; outputs as NetworkKernels::fit_texels().
  void fit(std::uint32_t branch, const Composition::Part& part, const TexelGroup& group,
           const std::vector<ViewSample>& view_samples, const TexelFit& how, Lanes* features, Lanes* error,
           Lanes* work) const;

 private:
  void fit_own(std::uint32_t branch, const TexelGroup& group, const std::vector<ViewSample>& view_samples,
               std::size_t iterations, Lanes* features, Lanes* error, Lanes* work) const;

  const Composition& composition_;
  const Student& student_;
  std::vector<FeatureNetwork> networks_;                 ///< per branch: its teacher, with the branch's rotation
  std::vector<std::vector<std::uint32_t>> branches_of_;  ///< per teacher: indices of its branches, the rigid one first
};

}  // namespace rebake
