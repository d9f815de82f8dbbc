#include "render/gpu_scene/packed_texels.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "mesh_ops/base/shelf_packer.h"
#include "mesh_ops/base/union_find.h"
#include "mesh_ops/index/footprint.h"

namespace rebake {

namespace {

// Share of the whole texture above which packing is not worthwhile.
constexpr double max_packed = 0.9;
constexpr int widest = 16384;  // maximum side of the packed texture

struct Range {
  int left = widest, top = widest, right = -1, bottom = -1;  ///< inclusive
};

// The texel that the shaders fetch at a coordinate, which they receive as a float.
int texel_at(double coordinate, int size) {
  return texel_within(static_cast<double>(static_cast<float>(coordinate)), size);
}

// Packs the tallest rectangles first. Returns the height; 0 if they do not fit into one texture.
int place_in_shelves(std::vector<PackedRect>& rects, int width) {
  std::vector<std::uint32_t> order(rects.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return rects[a].height > rects[b].height; });
  ShelfPacker packer(width, widest);
  packer.add(1, 1);  // texel (0, 0) stays free, for vertices without a rectangle
  for (const std::uint32_t k : order) {
    PackedRect& rect = rects[k];
    const ShelfPacker::Place place = packer.add(rect.width, rect.height);
    rect.place_x = static_cast<std::uint16_t>(place.x);
    rect.place_y = static_cast<std::uint16_t>(place.y);
  }
  return packer.pages().size() == 1 ? packer.pages().front().height : 0;
}

}  // namespace

TexelPacking pack_texels(const TextureSet& set, const std::vector<std::uint8_t>& shown) {
  const Soup& soup = set.soup;
  const int width = set.texels->width(), height = set.texels->height();
  const std::size_t count = soup.positions().size();
  UnionFind parts(count);
  for (const Face& face : soup.faces()) {
    parts.join(face[0], face[1]);
    parts.join(face[1], face[2]);
  }
  std::vector<Range> ranges(count);
  std::vector<std::uint8_t> part_shown(count, 0);
  for (std::size_t f = 0; f < soup.faces().size(); ++f) {
    const Face& face = soup.faces()[f];
    const std::uint32_t part = parts.root(face[0]);
    part_shown[part] |= shown[f];
    for (const std::uint32_t vertex : face) {
      const Vec2& uv = soup.uvs()[vertex];
      // With a NaN or infinite UV, the rectangle spans the whole texture.
      const bool sound = uv.allFinite();
      const int x = sound ? texel_at(uv.x() * width, width) : 0,
                y = sound ? texel_at((1 - uv.y()) * height, height) : 0;
      Range& range = ranges[part];
      range.left = std::min(range.left, x);
      range.top = std::min(range.top, y);
      range.right = std::max(range.right, sound ? x : width - 1);
      range.bottom = std::max(range.bottom, sound ? y : height - 1);
    }
  }
  TexelPacking packing;
  std::vector<std::uint32_t> rect_of_part(count, 0);
  double area = 1;
  int widest_rect = 1;
  std::vector<std::uint32_t> shown_parts;
  for (std::uint32_t part = 0; part < count; ++part)
    if (part_shown[part] != 0) shown_parts.push_back(part);
  // Sorted by tile, so that each parallel task of coded() unpacks few tiles.
  const auto in_order = [&](std::uint32_t part) {
    const Range& r = ranges[part];
    return std::tuple(r.top / TexelTile::size, r.left / TexelTile::size, r.top, r.left, part);
  };
  std::sort(shown_parts.begin(), shown_parts.end(),
            [&](std::uint32_t a, std::uint32_t b) { return in_order(a) < in_order(b); });
  for (const std::uint32_t part : shown_parts) {
    const Range& r = ranges[part];
    rect_of_part[part] = static_cast<std::uint32_t>(packing.rects.size());
    packing.rects.push_back({static_cast<std::uint16_t>(r.left), static_cast<std::uint16_t>(r.top),
                             static_cast<std::uint16_t>(r.right - r.left + 1),
                             static_cast<std::uint16_t>(r.bottom - r.top + 1), 0, 0});
    area += static_cast<double>(r.right - r.left + 1) * (r.bottom - r.top + 1);
    widest_rect = std::max(widest_rect, r.right - r.left + 1);
  }
  packing.rect_of_vertex.resize(count);
  const auto none = static_cast<std::uint32_t>(packing.rects.size());
  for (std::uint32_t v = 0; v < count; ++v) {
    const std::uint32_t part = parts.root(v);
    packing.rect_of_vertex[v] = part_shown[part] != 0 ? rect_of_part[part] : none;
  }
  const double all = static_cast<double>(width) * height;
  packing.width = std::clamp(static_cast<int>(std::ceil(std::sqrt(area))), std::max(widest_rect, 2), widest);
  packing.height = area < max_packed * all ? place_in_shelves(packing.rects, packing.width) : 0;
  if (packing.height == 0 || static_cast<double>(packing.width) * packing.height >= max_packed * all) {
    packing.whole = true;
    packing.width = width;
    packing.height = height;
    for (PackedRect& rect : packing.rects) {
      rect.place_x = rect.x;
      rect.place_y = rect.y;
    }
  }
  return packing;
}

void fill_packed_rows(const TexelPacking& packing, const TexelReader& texels, int first_row, int rows,
                      std::vector<Texel>& filled) {
  const auto width = static_cast<std::size_t>(packing.width);
  filled.assign(width * static_cast<std::size_t>(rows), Texel{});
  const auto copy = [&](int x, int y, int count, int to_x, int to_row) {
    Texel* to = &filled[static_cast<std::size_t>(to_row) * width + static_cast<std::size_t>(to_x)];
    for (int done = 0; done < count;) {
      const int part = std::min(count - done, TexelTile::size - (x + done) % TexelTile::size);
      std::copy_n(texels.row_part(x + done, y), part, to + done);
      done += part;
    }
  };
  if (packing.whole) {
    for (int y = 0; y < rows; ++y) copy(0, first_row + y, packing.width, 0, y);
    return;
  }
  for (const PackedRect& rect : packing.rects)
    for (int y = std::max<int>(rect.place_y, first_row); y < std::min(rect.place_y + rect.height, first_row + rows);
         ++y)
      copy(rect.x, rect.y + y - rect.place_y, rect.width, rect.place_x, y - first_row);
}

std::vector<std::uint8_t> changed_tiles(const FeatureTexture& before, const FeatureTexture& after) {
  std::vector<std::uint8_t> changed;
  for (int row = 0; row < after.tile_rows(); ++row)
    for (int column = 0; column < after.tile_columns(); ++column)
      changed.push_back(before.tile(column, row) != after.tile(column, row) ? 1 : 0);
  return changed;
}

bool any_newly_opaque(const FeatureTexture& before, const FeatureTexture& after) {
  for (int row = 0; row < after.tile_rows(); ++row)
    for (int column = 0; column < after.tile_columns(); ++column) {
      const TexelTile &was = *before.tile(column, row), &is = *after.tile(column, row);
      if (&was == &is || is.opaque_count() == 0) continue;
      if (is.more_opaque_than(was)) return true;
    }
  return false;
}

}  // namespace rebake
