#include "mesh_ops/features/atlas/atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/shelf_packer.h"

namespace rebake {

namespace {

// Destination of a patch.
struct Place {
  std::size_t set, patch;
  std::size_t page = 0;
  int x = 0, y = 0;
};

using Page = ShelfPacker::Page;

// A rectangle of texels that is copied to another texture.
struct Move {
  std::shared_ptr<const FeatureTexture> from;
  TexelRect rect;    // in `from`
  int x = 0, y = 0;  // destination of its top left texel
};

// A part of a move that lies in one tile of its source.
struct TilePart {
  const Move* move;
  std::size_t tile;
  TexelRect rect;
};

// The parts of moves whose destination is in rows `first` … `first + count - 1`, grouped by source tile.
std::vector<TilePart> parts_in_rows(const std::vector<Move>& moves, int first, int count) {
  std::vector<TilePart> parts;
  for (const Move& move : moves) {
    const int top = std::max(move.rect.top, move.rect.top + first - move.y);
    const int bottom = std::min(move.rect.bottom, move.rect.top + first + count - 1 - move.y);
    for (int y = top; y <= bottom; y = (y / TexelTile::size + 1) * TexelTile::size)
      for (int x = move.rect.left; x <= move.rect.right; x = (x / TexelTile::size + 1) * TexelTile::size)
        parts.push_back({&move,
                         move.from->tile_number(x, y),
                         {x, y, std::min(move.rect.right, x / TexelTile::size * TexelTile::size + TexelTile::size - 1),
                          std::min(bottom, y / TexelTile::size * TexelTile::size + TexelTile::size - 1)}});
  }
  std::stable_sort(parts.begin(), parts.end(), [](const TilePart& a, const TilePart& b) {
    return std::pair(a.move->from.get(), a.tile) < std::pair(b.move->from.get(), b.tile);
  });
  return parts;
}

TexelRows moved_texels(const Page& page, AlphaCode code, std::vector<Move> moves) {
  const auto shared = std::make_shared<const std::vector<Move>>(std::move(moves));
  return {
      page.width, page.height, [shared, code, width = page.width](int first, int count, Texel* rows) {
        std::fill_n(rows, static_cast<std::ptrdiff_t>(width) * count, empty_texel(code));
        // Each source tile is unpacked once.
        std::shared_ptr<const TexelTile::Texels> texels;
        const TilePart* unpacked = nullptr;
        const std::vector<TilePart> parts = parts_in_rows(*shared, first, count);
        for (const TilePart& part : parts) {
          const Move& move = *part.move;
          if (unpacked == nullptr || unpacked->move->from != move.from || unpacked->tile != part.tile) {
            const int columns = move.from->tile_columns();
            texels =
                move.from->tile(static_cast<int>(part.tile) % columns, static_cast<int>(part.tile) / columns)->texels();
            unpacked = &part;
          }
          for (int y = part.rect.top; y <= part.rect.bottom; ++y) {
            const auto from = texels->begin() + y % TexelTile::size * TexelTile::size;
            Texel* const to = rows + static_cast<std::ptrdiff_t>(move.y + y - move.rect.top - first) * width + move.x +
                              part.rect.left - move.rect.left;
            std::transform(from + part.rect.left % TexelTile::size, from + part.rect.right % TexelTile::size + 1, to,
                           [&](const Texel& texel) { return converted_texel(texel, move.from->alpha_code(), code); });
          }
        }
      }};
}

}  // namespace

bool can_pack(const TextureSet& set) {
  for (const Face& face : set.soup.faces())
    for (const std::uint32_t vertex : face) {
      const Vec2& uv = set.soup.uvs()[vertex];
      if (!(uv.x() >= 0 && uv.x() <= 1 && uv.y() >= 0 && uv.y() <= 1)) return false;
    }
  return true;
}

std::shared_ptr<const FeatureTexture> with_alpha_code(const std::shared_ptr<const FeatureTexture>& texture,
                                                      AlphaCode code) {
  if (texture->alpha_code() == code) return texture;
  return std::make_shared<const FeatureTexture>(
      FeatureTexture::from_tile_rows(texture->width(), texture->height(), code, rows_of(texture, code).read));
}

PackedSets pack(const std::vector<TextureSet>& sets, int largest_side, AlphaCode code,
                const PatchRepresentatives& representative_of) {
  PackedSets result;
  for (PackedPage& page : packed_pages(sets, largest_side, code, representative_of)) {
    const auto& [width, height, read] = page.texels;
    result.sets.push_back({std::move(page.soup), std::make_shared<const FeatureTexture>(
                                                     FeatureTexture::from_tile_rows(width, height, code, read))});
    result.patches.push_back(std::move(page.patches));
    result.texel_area += static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  }
  return result;
}

namespace {

// The patches of all sets, and where they go.
struct Packing {
  std::vector<TexelPatches> patches;         // per set
  std::vector<std::vector<Place>> place_of;  // per set and patch
  std::vector<Page> pages;
  std::vector<std::vector<Move>> moves;  // per page

  const TexelRect& rect_at(const Place& place) const { return patches[place.set].rects[place.patch]; }
};

// Finds the patches. Returns those that get a place of their own: all, or the representatives.
std::vector<Place> find_patches(Packing& packing, const std::vector<TextureSet>& sets, int largest_side,
                                const PatchRepresentatives& representative_of) {
  std::vector<Place> places;
  for (std::size_t s = 0; s < sets.size(); ++s) {
    if (!can_pack(sets[s])) throw Error("texels cannot be repacked: some UVs are outside 0 … 1");
    packing.patches.push_back(texel_patches(sets[s]));
    for (std::size_t p = 0; p < packing.patches[s].rects.size(); ++p) {
      const TexelRect& rect = packing.patches[s].rects[p];
      if (rect.width() > largest_side || rect.height() > largest_side)
        throw Error(fmt::format("a patch of {}×{} texels does not fit into a texture of {}² texels", rect.width(),
                                rect.height(), largest_side));
      if (representative_of.empty() || representative_of[s][p] == PatchNumber{s, p}) places.push_back({s, p});
    }
  }
  return places;
}

Packing packing_of(const std::vector<TextureSet>& sets, int largest_side,
                   const PatchRepresentatives& representative_of) {
  Packing packing;
  std::vector<Place> places = find_patches(packing, sets, largest_side, representative_of);
  const auto rect_at = [&](const Place& place) -> const TexelRect& { return packing.rect_at(place); };
  std::uint64_t area = 0;
  int widest = 1;
  for (const Place& place : places) {
    const TexelRect& rect = rect_at(place);
    area += static_cast<std::uint64_t>(rect.width()) * static_cast<std::uint64_t>(rect.height());
    widest = std::max(widest, rect.width());
  }
  std::stable_sort(places.begin(), places.end(), [&](const Place& a, const Place& b) {
    return std::pair(rect_at(a).height(), rect_at(a).width()) > std::pair(rect_at(b).height(), rect_at(b).width());
  });
  // Nearly square pages, whose width is a multiple of the widest patch.
  const auto side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(area))));
  ShelfPacker packer(std::min(largest_side / widest * widest, std::max(1, (side + widest - 1) / widest) * widest),
                     largest_side);
  for (Place& place : places) {
    const auto [page, x, y] = packer.add(rect_at(place).width(), rect_at(place).height());
    place.page = page;
    place.x = x;
    place.y = y;
  }
  packing.pages = packer.pages();
  packing.moves.resize(packing.pages.size());
  packing.place_of.resize(sets.size());
  for (std::size_t s = 0; s < sets.size(); ++s) packing.place_of[s].resize(packing.patches[s].rects.size());
  for (const Place& place : places) {
    packing.place_of[place.set][place.patch] = place;
    packing.moves[place.page].push_back({sets[place.set].texels, rect_at(place), place.x, place.y});
  }
  for (std::size_t s = 0; s < representative_of.size(); ++s)
    for (std::size_t p = 0; p < representative_of[s].size(); ++p) {
      const Place& shown = packing.place_of[representative_of[s][p].set][representative_of[s][p].patch];
      packing.place_of[s][p] = {s, p, shown.page, shown.x, shown.y};
    }
  return packing;
}

// The triangles of a page while sets are added.
struct PageSoup {
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;
  std::vector<Face> faces;
  TexelPatches patches;
  Attributes vertex_attributes, face_attributes;
};

// Adds the triangles of set number `s` to the pages of their patches.
void add_triangles(const Packing& packing, const TextureSet& set, std::size_t s, std::vector<PageSoup>& soups) {
  constexpr auto absent = std::numeric_limits<std::uint32_t>::max();
  const TexelPatches& patches = packing.patches[s];
  const Soup& soup = set.soup;
  const double old_width = set.texels->width(), old_height = set.texels->height();
  // A vertex belongs to one patch, because the faces that share it share its texel. So one pass over the vertices
  // preserves their order.
  std::vector<std::size_t> patch_of_vertex(soup.positions().size(), absent);
  for (std::size_t f = 0; f < soup.faces().size(); ++f)
    for (const std::uint32_t vertex : soup.faces()[f]) patch_of_vertex[vertex] = patches.of_face[f];
  std::vector<std::uint32_t> renumbered(soup.positions().size(), absent);
  struct Kept {
    std::vector<std::uint32_t> vertices, faces;
  };
  std::vector<Kept> kept(packing.pages.size());
  for (std::size_t v = 0; v < soup.positions().size(); ++v) {
    if (patch_of_vertex[v] == absent) continue;
    const Place& place = packing.place_of[s][patch_of_vertex[v]];
    const TexelRect& rect = packing.rect_at(place);
    const Page& page = packing.pages[place.page];
    PageSoup& out = soups[place.page];
    renumbered[v] = static_cast<std::uint32_t>(out.positions.size());
    out.positions.push_back(soup.positions()[v]);
    const Vec2& uv = soup.uvs()[v];
    out.uvs.emplace_back((uv.x() * old_width + (place.x - rect.left)) / page.width,
                         1 - ((1 - uv.y()) * old_height + (place.y - rect.top)) / page.height);
    kept[place.page].vertices.push_back(static_cast<std::uint32_t>(v));
  }
  std::vector<std::size_t> number_in_page;
  for (const Place& place : packing.place_of[s]) {
    const TexelRect& rect = packing.rect_at(place);
    std::vector<TexelRect>& rects = soups[place.page].patches.rects;
    number_in_page.push_back(rects.size());
    rects.push_back({place.x, place.y, place.x + rect.width() - 1, place.y + rect.height() - 1});
  }
  for (std::size_t f = 0; f < soup.faces().size(); ++f) {
    Face face = soup.faces()[f];
    for (std::uint32_t& vertex : face) vertex = renumbered[vertex];
    const std::size_t page = packing.place_of[s][patches.of_face[f]].page;
    soups[page].faces.push_back(face);
    soups[page].patches.of_face.push_back(number_in_page[patches.of_face[f]]);
    kept[page].faces.push_back(static_cast<std::uint32_t>(f));
  }
  for (std::size_t page = 0; page < soups.size(); ++page) {
    PageSoup& out = soups[page];
    const std::size_t vertices = kept[page].vertices.size(), faces = kept[page].faces.size();
    out.vertex_attributes = out.vertex_attributes.followed_by(
        out.positions.size() - vertices, soup.vertex_attributes().picked(kept[page].vertices), vertices);
    out.face_attributes = out.face_attributes.followed_by(out.faces.size() - faces,
                                                          soup.face_attributes().picked(kept[page].faces), faces);
  }
}

}  // namespace

std::vector<PackedPage> packed_pages(const std::vector<TextureSet>& sets, int largest_side, AlphaCode code,
                                     const PatchRepresentatives& representative_of) {
  Packing packing = packing_of(sets, largest_side, representative_of);
  std::vector<PageSoup> soups(packing.pages.size());
  for (std::size_t s = 0; s < sets.size(); ++s) add_triangles(packing, sets[s], s, soups);
  std::vector<PackedPage> result;
  for (std::size_t k = 0; k < soups.size(); ++k) {
    PageSoup& soup = soups[k];
    result.push_back({Soup(std::make_shared<const std::vector<Vec3>>(std::move(soup.positions)),
                           std::make_shared<const std::vector<Vec2>>(std::move(soup.uvs)),
                           std::make_shared<const std::vector<Face>>(std::move(soup.faces)),
                           std::move(soup.vertex_attributes), std::move(soup.face_attributes)),
                      moved_texels(packing.pages[k], code, std::move(packing.moves[k])), std::move(soup.patches)});
  }
  return result;
}

}  // namespace rebake
