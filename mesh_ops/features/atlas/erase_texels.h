#pragma once

#include <functional>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Result of erase_texels().
struct Erased {
  std::vector<TextureSet> sets;
  std::uint64_t texels = 0;  ///< number of texels that became transparent
};
/// Clears the opacity (feat0.R) of texels whose place satisfies `inside`. A texel's place is the point of a triangle
/// nearest to the texel's centre, in object space. All other bytes stay as they are, and tiles without a cleared texel
/// stay shared. A texel used by several triangles is cleared if one of its places is inside. `may_touch`: whether the
/// triangle with these corners may contain such a place; if not, its texels are skipped. Both functions must be
/// thread-safe.
Erased erase_texels(const BakedObject& object, const std::function<bool(const Vec3&)>& inside,
                    const std::function<bool(const std::array<Vec3, 3>&)>& may_touch);

}  // namespace rebake
