#pragma once

#include <array>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// What a triangle looks like, for selecting by likeness. Object space.
struct TriangleTraits {
  std::array<float, 8> features{};  ///< mean of its opaque texels' decoded features
  std::array<float, 3> color{};     ///< those features decoded, averaged over six axis directions; 0 … 1
  float opacity = 0;                ///< share of its texels that are opaque
  float area = 0;                   ///< in square units
  std::array<float, 3> normal{};    ///< unit, or zero where the triangle has no area
};

/// Traits of every triangle, in the object's numbering. A triangle too small to hold a texel centre counts the texel at
/// its own centre.
std::vector<TriangleTraits> triangle_traits(const BakedObject& object);

}  // namespace rebake
