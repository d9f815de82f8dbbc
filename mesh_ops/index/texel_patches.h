#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// An axis-aligned rectangle of texels; row 0 is at the top.
struct TexelRect {
  int left = 0, top = 0, right = 0, bottom = 0;  ///< right and bottom are inclusive
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

/// Groups of faces whose texel rectangles overlap.
struct TexelPatches {
  std::vector<TexelRect> rects;      ///< bounding rectangle per patch
  std::vector<std::size_t> of_face;  ///< patch number per face
};
TexelPatches texel_patches(const TextureSet& set);

/// Bounding rectangle of a face's texels, clamped to the texture.
TexelRect texel_rect(const TextureSet& set, const Face& face);

}  // namespace rebake
