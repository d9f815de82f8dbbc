#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
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

/// The rectangle that a face's texels lie in.
TexelRect texel_rect(const TextureSet& set, const Face& face);

}  // namespace rebake
