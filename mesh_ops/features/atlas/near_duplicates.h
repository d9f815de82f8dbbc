#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/features/atlas/atlas.h"
#include "mesh_ops/scene/object.h"

namespace rebake {

/// Near-duplicate patches of an object's textures. A duplicate uses the texels of its representative.
struct DuplicatePatches {
  PatchRepresentatives representative_of;  ///< per set and patch (texel_patches): its representative
  std::size_t merged = 0;                  ///< number of duplicates
  std::size_t patches = 0;                 ///< total number of patches
  std::uint64_t texels = 0;                ///< opaque texels of the duplicates, which become unused
  double squared_loss = 0;  ///< mean squared error of display colours over all opaque texels, channels and directions
};

/// Finds patches of equal size and opacity whose display colours differ by at most `squared_loss` (mean square over
/// opaque texels, a few directions and channels). The first of them in order is the representative; representatives
/// keep their own texels. Candidates are found by features weighted by their effect on colours, and accepted by decoded
/// colours. The result is empty if texels cannot be moved. Deterministic.
DuplicatePatches near_duplicate_patches(const BakedObject& object, double squared_loss, const Progress& progress = {});

}  // namespace rebake
