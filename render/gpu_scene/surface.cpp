#include "render/gpu_scene/surface.h"

#include <epoxy/gl.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "mesh_ops/index/opacity.h"

namespace rebake {

namespace {

// The parts of a rectangle that lie in changed tiles. Returns how many texels that is.
std::uint64_t upload_changed(const TexelReader& texels, int tile_columns, const std::vector<std::uint8_t>& changed,
                             const PackedRect& rect, std::vector<Texel>& rows) {
  constexpr int size = TexelTile::size;
  std::uint64_t uploaded = 0;
  for (int row = rect.y / size; row <= (rect.y + rect.height - 1) / size; ++row)
    for (int column = rect.x / size; column <= (rect.x + rect.width - 1) / size; ++column) {
      if (changed[static_cast<std::size_t>(row) * static_cast<std::size_t>(tile_columns) +
                  static_cast<std::size_t>(column)] == 0)
        continue;
      const int left = std::max<int>(rect.x, column * size), top = std::max<int>(rect.y, row * size);
      const int width = std::min(rect.x + rect.width, (column + 1) * size) - left,
                height = std::min(rect.y + rect.height, (row + 1) * size) - top;
      rows.clear();
      for (int y = top; y < top + height; ++y)
        rows.insert(rows.end(), texels.row_part(left, y), texels.row_part(left, y) + width);
      glTexSubImage2D(GL_TEXTURE_2D, 0, rect.place_x + left - rect.x, rect.place_y + top - rect.y, width, height,
                      GL_RG_INTEGER, GL_UNSIGNED_INT, rows.data());
      uploaded += rows.size();
    }
  return uploaded;
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
    if (number == packing->rects.size()) {
      if (!packing->whole) return;
      // Its own texels are there too.
      vertex.last_texel[0] = static_cast<std::uint16_t>(packing->width - 1);
      vertex.last_texel[1] = static_cast<std::uint16_t>(packing->height - 1);
      return;
    }
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

GpuSurface begin_upload(PreparedSurface made) {
  GpuSurface surface;
  // The element buffer is bound to no vertex array here.
  glBindVertexArray(0);
  surface.vertices =
      gl::make_buffer(GL_ARRAY_BUFFER, made.vertices.data(), made.vertices.size() * sizeof(SurfaceVertex));
  surface.indices = gl::make_buffer(GL_ARRAY_BUFFER, made.shown.faces->data(), made.shown.faces->size() * sizeof(Face));
  surface.texels = gl::make_texture(GL_RG32UI, made.packing->width, made.packing->height, sizeof(Texel));
  surface.made_for = made.source.texels;
  surface.source = std::move(made.source);
  surface.shown = std::move(made.shown);
  surface.packing = std::move(made.packing);
  return surface;
}

bool upload_rows(GpuSurface& surface, int count) {
  const TexelPacking& packing = *surface.packing;
  count = std::min(count, packing.height - surface.rows_uploaded);
  if (count > 0) {
    std::vector<Texel> rows;
    if (!surface.reading) surface.reading = std::make_unique<const TexelReader>(*surface.source.texels);
    fill_packed_rows(packing, *surface.reading, surface.rows_uploaded, count, rows);
    glBindTexture(GL_TEXTURE_2D, surface.texels.name());
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, surface.rows_uploaded, packing.width, count, GL_RG_INTEGER, GL_UNSIGNED_INT,
                    rows.data());
    surface.rows_uploaded += count;
  }
  if (surface.rows_uploaded < packing.height) return false;
  surface.reading.reset();
  return true;
}

bool serves(const std::shared_ptr<const FeatureTexture>& made_for, const TextureSet& source, const TextureSet& set) {
  return source.soup.shared_uvs() == set.soup.shared_uvs() && source.soup.shared_faces() == set.soup.shared_faces() &&
         made_for->width() == set.texels->width() && made_for->height() == set.texels->height() &&
         !newly_opaque(*made_for, *set.texels);
}

std::uint64_t take_over(GpuSurface& surface, const TextureSet& set) {
  const FeatureTexture &before = *surface.source.texels, &after = *set.texels;
  const std::vector<std::uint8_t> changed = changed_tiles(before, after);
  glBindTexture(GL_TEXTURE_2D, surface.texels.name());
  const TexelReader texels(after);
  std::vector<Texel> rows;
  std::uint64_t uploaded = 0;
  if (surface.packing->whole)
    uploaded = upload_changed(
        texels, after.tile_columns(), changed,
        {0, 0, static_cast<std::uint16_t>(after.width()), static_cast<std::uint16_t>(after.height()), 0, 0}, rows);
  else
    for (const PackedRect& rect : surface.packing->rects)
      uploaded += upload_changed(texels, after.tile_columns(), changed, rect, rows);
  surface.source = set;
  surface.reading.reset();
  return uploaded;
}

}  // namespace rebake
