#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/features/atlas.h"
#include "mesh_ops/scene/object.h"

namespace rebake {

/// Patches of texels that may show others' texels instead of their own.
struct AlikePatches {
  ShownBy shown_by;        ///< of each set, each patch (texel_patches)
  std::size_t merged = 0;  ///< patches that show another's texels
  std::size_t patches = 0;
  std::uint64_t texels = 0;  ///< opaque ones that no patch shows any more
  double squared_loss = 0;   ///< of display colours, over all opaque texels, channels and directions
};

/// Finds patches of one size and opacity whose display colours differ by at most `squared_loss` in the mean square over
/// their opaque texels, a few directions and channels. Each follows the first that it is like; what is followed follows
/// none. Candidates are found by their features, weighted by what these do to colours; only what is decoded counts.
/// Nothing where texels cannot be moved. Deterministic.
AlikePatches alike_patches(const BakedObject& object, double squared_loss, const Progress& progress = {});

}  // namespace rebake
