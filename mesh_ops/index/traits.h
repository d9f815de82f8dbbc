#pragma once

#include <array>
#include <memory>
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

/// What of a triangle's traits its texels say, wherever its corners lie.
struct TriangleLooks {
  std::array<float, 8> features{};
  std::array<float, 3> color{};
  float opacity = 0;
};
/// Of a set's triangles. One too small to hold a texel centre counts the texel at its own centre.
std::vector<TriangleLooks> triangle_looks(const TextureSet& set, const Decoder& decoder);

/// Whether one triangle's TriangleLooks::opacity is above 0; looks at no colour.
bool shows_opaque(const TextureSet& set, std::size_t triangle);

/// Traits of every triangle, in the object's numbering, from the looks of each set's.
std::vector<TriangleTraits> triangle_traits(
    const BakedObject& object, const std::vector<std::shared_ptr<const std::vector<TriangleLooks>>>& looks);

}  // namespace rebake
