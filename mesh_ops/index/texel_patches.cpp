#include "mesh_ops/index/texel_patches.h"

#include <array>
#include <map>
#include <unordered_map>

#include "mesh_ops/base/union_find.h"
#include "mesh_ops/index/footprint.h"

namespace rebake {

TexelRect texel_rect(const TextureSet& set, const Face& face) {
  const int width = set.texels->width(), height = set.texels->height();
  double low_u = 2, high_u = -1, low_v = 2, high_v = -1;
  for (const std::uint32_t vertex : face) {
    const Vec2& uv = set.soup.uvs()[vertex];
    low_u = std::min(low_u, uv.x());
    high_u = std::max(high_u, uv.x());
    low_v = std::min(low_v, uv.y());
    high_v = std::max(high_v, uv.y());
  }
  return {texel_within(low_u * width, width), texel_within((1 - high_v) * height, height),
          texel_within(high_u * width, width), texel_within((1 - low_v) * height, height)};
}

TexelPatches texel_patches(const TextureSet& set) {
  const auto& faces = set.soup.faces();
  std::map<TexelRect, std::size_t> known;
  std::vector<TexelRect> rects;
  std::vector<std::size_t> rect_of_face;
  for (const Face& face : faces) {
    const TexelRect rect = texel_rect(set, face);
    const auto [it, fresh] = known.try_emplace(rect, rects.size());
    if (fresh) rects.push_back(rect);
    rect_of_face.push_back(it->second);
  }
  // Only rectangles in the same block of 32 × 32 texels can overlap. Rectangles of a crowded block are joined without a
  // test: patches become larger, but stay valid.
  constexpr int block = 32;
  constexpr std::size_t crowded = 64;
  UnionFind groups(rects.size());
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> in_block;
  for (std::uint32_t r = 0; r < rects.size(); ++r) {
    for (int y = rects[r].top / block; y <= rects[r].bottom / block; ++y) {
      for (int x = rects[r].left / block; x <= rects[r].right / block; ++x) {
        auto& others = in_block[static_cast<std::uint64_t>(y) << 32 | static_cast<std::uint32_t>(x)];
        for (const std::uint32_t other : others)
          if (others.size() > crowded || rects[other].overlaps(rects[r])) groups.join(other, r);
        if (others.size() <= crowded) others.push_back(r);
      }
    }
  }
  TexelPatches result;
  std::unordered_map<std::size_t, std::size_t> patch_of_root;
  std::vector<std::size_t> patch_of_rect(rects.size());
  for (std::uint32_t r = 0; r < rects.size(); ++r) {
    const auto [it, fresh] = patch_of_root.try_emplace(groups.root(r), result.rects.size());
    if (fresh)
      result.rects.push_back(rects[r]);
    else
      result.rects[it->second].join(rects[r]);
    patch_of_rect[r] = it->second;
  }
  for (const std::size_t r : rect_of_face) result.of_face.push_back(patch_of_rect[r]);
  return result;
}

}  // namespace rebake
