#pragma once

#include <array>
#include <memory>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Appearance and shape of a triangle in object space, for selecting similar triangles.
struct TriangleTraits {
  std::array<float, 8> features{};  ///< mean of the decoded features of its opaque texels
  std::array<float, 3> color{};  ///< display colour of the mean features, averaged over the six axis directions; 0 … 1
  /// Share of opaque texels among those whose centres are inside; if that is 0, share of the area that opaque texels
  /// cover. 0 if that is below a millionth.
  float opacity = 0;
  double area = 0;                ///< in square object units; 0 if it is not larger than the rounding of the corners
  std::array<float, 3> normal{};  ///< unit vector, or zero if the triangle has no area
};

/// The traits of a triangle that depend on its texels and the decoder, but not on vertex positions.
struct TexelTraits {
  std::array<float, 8> features{};
  std::array<float, 3> color{};
  float opacity = 0;
};
/// Texel-dependent traits per triangle of a set. A triangle that contains no texel centre uses the texel at its
/// centroid.
std::vector<TexelTraits> texel_traits(const TextureSet& set, const Decoder& decoder);

/// Whether TexelTraits::opacity of one triangle is above 0; decodes no colours.
bool shows_opaque(const TextureSet& set, std::size_t triangle);

/// Traits per triangle, in the object's numbering. `looks`: texel_traits() per texture set.
std::vector<TriangleTraits> triangle_traits(const BakedObject& object,
                                            const std::vector<std::shared_ptr<const std::vector<TexelTraits>>>& looks);

}  // namespace rebake
