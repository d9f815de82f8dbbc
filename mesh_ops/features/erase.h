#pragma once

#include <functional>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Clears the opacity (feat0.R) of texels that show a place for which `inside` holds: a texel's place is the point of a
/// triangle nearest to the texel's centre, in object space. All other bytes stay as they are, and tiles without a
/// cleared texel stay shared. A texel that several triangles show is cleared for all. `inside` is called from several
/// threads.
struct Erased {
  std::vector<TextureSet> sets;
  std::uint64_t texels = 0;  ///< opaque before, transparent now
};
/// `may_touch` says of three corners whether the triangle between them may hold such a place; where it says no the
/// triangle's texels are not looked at.
Erased erase_texels(const BakedObject& object, const std::function<bool(const Vec3&)>& inside,
                    const std::function<bool(const std::array<Vec3, 3>&)>& may_touch);

}  // namespace rebake
