#include "render/gpu_scene/surface.h"

#include <epoxy/gl.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "mesh_ops/index/opacity.h"

namespace rebake {

namespace {

// Rows that are uploaded at a time.
constexpr int band = 256;

void upload_rows(const TexelPacking& packing, const FeatureTexture& texels) {
  std::vector<Texel> rows;
  for (int first = 0; first < packing.height; first += band) {
    const int count = std::min(band, packing.height - first);
    fill_packed_rows(packing, texels, first, count, rows);
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, first, packing.width, count, GL_RG_INTEGER, GL_UNSIGNED_INT, rows.data());
  }
}

void upload_rect(const FeatureTexture& texels, const PackedRect& rect, std::vector<Texel>& rows) {
  TexelPacking one;
  one.width = rect.width;
  one.height = rect.height;
  one.rects.push_back({rect.x, rect.y, rect.width, rect.height, 0, 0});
  fill_packed_rows(one, texels, 0, rect.height, rows);
  glTexSubImage2D(GL_TEXTURE_2D, 0, rect.place_x, rect.place_y, rect.width, rect.height, GL_RG_INTEGER, GL_UNSIGNED_INT,
                  rows.data());
}

}  // namespace

PreparedSurface prepared_surface(const TextureSet& set) {
  const Soup& soup = set.soup;
  PreparedSurface made;
  made.source = set;
  // Faces that show nothing are not worth a draw.
  const std::vector<std::uint8_t> shows = faces_with_opaque_texels(set);
  auto faces = std::make_shared<std::vector<Face>>();
  for (std::size_t f = 0; f < shows.size(); ++f)
    if (shows[f] != 0) faces->push_back(soup.faces()[f]);
  made.shown.nearby = nearby_order(soup, *faces);
  made.shown.faces = std::move(faces);
  const auto packing = std::make_shared<const TexelPacking>(pack_texels(set, shows));
  made.packing = packing;
  made.vertices.resize(soup.uvs().size());
  const double width = set.texels->width(), height = set.texels->height();
  tbb::parallel_for(std::size_t{0}, made.vertices.size(), [&](std::size_t v) {
    const Vec2& uv = soup.uvs()[v];
    SurfaceVertex& vertex = made.vertices[v];
    vertex = {{static_cast<float>(uv.x() * width), static_cast<float>((1 - uv.y()) * height)}, {}, {}, {}};
    const std::uint32_t number = packing->rect_of_vertex[v];
    if (number == packing->rects.size()) return;
    const PackedRect& rect = packing->rects[number];
    vertex.first_texel[0] = rect.x;
    vertex.first_texel[1] = rect.y;
    vertex.last_texel[0] = static_cast<std::uint16_t>(rect.x + rect.width - 1);
    vertex.last_texel[1] = static_cast<std::uint16_t>(rect.y + rect.height - 1);
    vertex.place[0] = rect.place_x;
    vertex.place[1] = rect.place_y;
  });
  return made;
}

GpuSurface upload(PreparedSurface made) {
  GpuSurface surface;
  // The element buffer is bound to no vertex array here.
  glBindVertexArray(0);
  surface.vertices =
      gl::make_buffer(GL_ARRAY_BUFFER, made.vertices.data(), made.vertices.size() * sizeof(SurfaceVertex));
  surface.indices = gl::make_buffer(GL_ARRAY_BUFFER, made.shown.faces->data(), made.shown.faces->size() * sizeof(Face));
  surface.texels = gl::make_texture(GL_RG32UI, made.packing->width, made.packing->height, sizeof(Texel));
  upload_rows(*made.packing, *made.source.texels);
  surface.made_for = made.source.texels;
  surface.source = std::move(made.source);
  surface.shown = std::move(made.shown);
  surface.packing = std::move(made.packing);
  return surface;
}

bool serves(const std::shared_ptr<const FeatureTexture>& made_for, const TextureSet& source, const TextureSet& set) {
  return source.soup.shared_uvs() == set.soup.shared_uvs() && source.soup.shared_faces() == set.soup.shared_faces() &&
         made_for->width() == set.texels->width() && made_for->height() == set.texels->height() &&
         !newly_opaque(*made_for, *set.texels);
}

void take_over(GpuSurface& surface, const TextureSet& set) {
  const FeatureTexture &before = *surface.source.texels, &after = *set.texels;
  const std::vector<std::uint8_t> changed = changed_tiles(before, after);
  const int columns = after.tile_columns();
  glBindTexture(GL_TEXTURE_2D, surface.texels.name());
  std::vector<Texel> rows;
  constexpr int size = TexelTile::size;
  if (surface.packing->whole) {
    for (std::size_t k = 0; k < changed.size(); ++k) {
      if (changed[k] == 0) continue;
      const int x = static_cast<int>(k) % columns * size, y = static_cast<int>(k) / columns * size;
      const auto at_x = static_cast<std::uint16_t>(x), at_y = static_cast<std::uint16_t>(y);
      upload_rect(after,
                  {at_x, at_y, static_cast<std::uint16_t>(std::min(size, after.width() - x)),
                   static_cast<std::uint16_t>(std::min(size, after.height() - y)), at_x, at_y},
                  rows);
    }
  } else {
    for (const PackedRect& rect : surface.packing->rects) {
      bool any = false;
      for (int y = rect.y / size; y <= (rect.y + rect.height - 1) / size; ++y)
        for (int x = rect.x / size; x <= (rect.x + rect.width - 1) / size; ++x)
          any =
              any ||
              changed[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x)] !=
                  0;
      if (any) upload_rect(after, rect, rows);
    }
  }
  surface.source = set;
}

}  // namespace rebake
