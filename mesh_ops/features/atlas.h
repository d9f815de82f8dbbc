#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// A rectangle of texels.
struct TexelRect {
  int left = 0, top = 0, right = 0, bottom = 0;  ///< right and bottom included
  auto operator<=>(const TexelRect&) const = default;
  bool overlaps(const TexelRect& o) const {
    return left <= o.right && o.left <= right && top <= o.bottom && o.top <= bottom;
  }
  void join(const TexelRect& o) {
    left = std::min(left, o.left);
    top = std::min(top, o.top);
    right = std::max(right, o.right);
    bottom = std::max(bottom, o.bottom);
  }
  int width() const { return right - left + 1; }
  int height() const { return bottom - top + 1; }
};

/// What of a texture belongs together: groups of faces whose rectangles of texels overlap.
struct TexelPatches {
  std::vector<TexelRect> rects;
  std::vector<std::size_t> of_face;  ///< number of a face's patch
};
TexelPatches texel_patches(const TextureSet& set);

/// Texels of some sets moved closer together, in as few textures of at most `largest_side`² as they need.
struct PackedSets {
  std::vector<TextureSet> sets;
  std::uint64_t texel_area = 0;  ///< width × height over all new textures
};

/// Moves the patches of texels that triangles use, whole and bit for bit, into new textures; drops the rest. UVs follow
/// by whole texels, so nearest sampling finds the same texels. Positions, turns and the order of faces within a texture
/// are kept. Textures of another alpha code than `code` are converted (halved from plain loses the alpha's lowest bit,
/// as the published exporter does). Throws Error for a patch larger than `largest_side`, and for UVs outside [0, 1].
PackedSets pack(const std::vector<TextureSet>& sets, int largest_side, AlphaCode code);

/// The texture with its alpha stored the other way; the same pointer when it already is.
std::shared_ptr<const FeatureTexture> with_alpha_code(const std::shared_ptr<const FeatureTexture>& texture,
                                                      AlphaCode code);

/// True when all UVs of the faces lie in [0, 1], so that texels can be moved.
bool can_pack(const TextureSet& set);

}  // namespace rebake
