#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/features/atlas.h"
#include "mesh_ops/scene/object.h"

namespace rebake {

/// Near-duplicate patches of texels that may use the texels of a representative instead of their own.
struct AlikePatches {
  ShownBy shown_by;        ///< per set and patch (texel_patches)
  std::size_t merged = 0;  ///< patches that use a representative's texels
  std::size_t patches = 0;
  std::uint64_t texels = 0;  ///< opaque texels that no patch uses any more
  double squared_loss = 0;   ///< mean square error of display colours over all opaque texels, channels and directions
};

/// Finds patches of equal size and opacity whose display colours differ by at most `squared_loss` (mean square over
/// opaque texels, a few directions and channels). The first of them in order is the representative; representatives
/// keep their own texels. Candidates are found by features weighted by their effect on colours, and accepted by decoded
/// colours. Empty if texels cannot be moved. Deterministic.
AlikePatches alike_patches(const BakedObject& object, double squared_loss, const Progress& progress = {});

}  // namespace rebake
