#include "render/gpu_scene/surface.h"

#include <epoxy/gl.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "mesh_ops/index/opacity.h"

namespace rebake {

namespace {

// Size of an upload slice: a few milliseconds' worth.
constexpr int band = 64;  // rows of texels
constexpr std::size_t bytes_at_once = 1 << 20;

// Uploads the parts of a rectangle that lie in changed tiles. Returns their number of texels.
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

std::uint64_t area_of(const std::vector<PackedRect>& rects) {
  std::uint64_t area = 0;
  for (const PackedRect& rect : rects) area += static_cast<std::uint64_t>(rect.width) * rect.height;
  return area;
}

// Codes texels; nullopt if they may exceed max_coded_words (a texel takes at most one word) or save less than a tenth:
// overlapping rectangles would be stored several times, and tiny ones are smaller uncoded.
std::optional<CodedTexels> code_if_worthwhile(const TexelPacking& packing, const FeatureTexture& texels) {
  constexpr double max_coded = 0.9;  // share of the uncoded size
  const double plain = static_cast<double>(sizeof(Texel)) * packing.width * packing.height;
  if (area_of(packing.rects) > max_coded_words) return std::nullopt;
  if (static_cast<double>(sizeof(Texel) * area_of(packing.rects)) > 2 * plain) return std::nullopt;
  CodedTexels made = coded(packing.rects, texels);
  const std::size_t bytes = made.blocks.size() * sizeof(TexelBlock) + made.words.size() * sizeof(std::uint64_t);
  if (static_cast<double>(bytes) > max_coded * plain) return std::nullopt;
  return made;
}

GpuCodedTexels begin_upload(CodedTexels coded) {
  // Padding: from the start of a texel's data, the shader reads three 32-bit halves of words.
  coded.words.resize(coded.words.size() + 2, 0);
  GpuCodedTexels made;
  made.blocks = gl::make_buffer(GL_TEXTURE_BUFFER, nullptr, coded.blocks.size() * sizeof(TexelBlock));
  made.words = gl::make_buffer(GL_TEXTURE_BUFFER, nullptr, coded.words.size() * sizeof(std::uint64_t));
  made.read_blocks = gl::make_buffer_texture(made.blocks, GL_RGBA32UI);
  made.read_words = gl::make_buffer_texture(made.words, GL_R32UI);
  made.first_block = coded.first_block;
  made.first_word = coded.first_word;
  made.waiting = std::move(coded);
  return made;
}

void upload_part(const gl::Buffer& buffer, std::size_t first, std::size_t bytes, const void* data) {
  glBindBuffer(GL_TEXTURE_BUFFER, buffer.name());
  glBufferSubData(GL_TEXTURE_BUFFER, static_cast<GLintptr>(first), static_cast<GLsizeiptr>(bytes), data);
}

// Uploads the next slice. Returns the uploaded share, 0 … 1.
double upload_some(GpuCodedTexels& coded) {
  const CodedTexels& waiting = coded.waiting;
  const std::size_t blocks = waiting.blocks.size() * sizeof(TexelBlock),
                    words = waiting.words.size() * sizeof(std::uint64_t);
  const std::size_t begin = coded.uploaded, end = std::min(begin + bytes_at_once, blocks + words);
  const auto part = [&](const gl::Buffer& buffer, std::size_t before, std::size_t size, const void* data) {
    const std::size_t first = std::clamp(begin, before, before + size) - before,
                      last = std::clamp(end, before, before + size) - before;
    if (last > first) upload_part(buffer, first, last - first, static_cast<const std::byte*>(data) + first);
  };
  part(coded.blocks, 0, blocks, waiting.blocks.data());
  part(coded.words, blocks, words, waiting.words.data());
  coded.uploaded = end;
  if (end < blocks + words) return static_cast<double>(end) / static_cast<double>(blocks + words);
  coded.waiting = {};
  return 1;
}

bool touches(const PackedRect& rect, int tile_columns, const std::vector<std::uint8_t>& changed) {
  constexpr int size = TexelTile::size;
  for (int row = rect.y / size; row <= (rect.y + rect.height - 1) / size; ++row)
    for (int column = rect.x / size; column <= (rect.x + rect.width - 1) / size; ++column)
      if (changed[static_cast<std::size_t>(row) * static_cast<std::size_t>(tile_columns) +
                  static_cast<std::size_t>(column)] != 0)
        return true;
  return false;
}

// Recodes the rectangles in changed tiles, within the words allocated for them, and uploads runs of them at once.
// Returns their number of texels; nullopt if they need more words.
std::optional<std::uint64_t> recode_changed_rects(const GpuCodedTexels& coded, const std::vector<PackedRect>& rects,
                                                  const TexelReader& texels, int tile_columns,
                                                  const std::vector<std::uint8_t>& changed) {
  std::uint64_t recoded = 0;
  std::vector<TexelBlock> blocks;
  std::vector<std::uint64_t> words;
  for (std::size_t k = 0; k < rects.size(); ++k) {
    const std::size_t first = k;
    blocks.clear();
    words.clear();
    for (; k < rects.size() && touches(rects[k], tile_columns, changed); ++k) {
      append_coded(rects[k], texels, coded.first_word[k], blocks, words);
      const std::size_t end = coded.first_word[k + 1] - coded.first_word[first];
      if (words.size() > end) return std::nullopt;
      words.resize(end, 0);
      recoded += static_cast<std::uint64_t>(rects[k].width) * rects[k].height;
    }
    if (k == first) continue;
    upload_part(coded.blocks, coded.first_block[first] * sizeof(TexelBlock), blocks.size() * sizeof(TexelBlock),
                blocks.data());
    upload_part(coded.words, coded.first_word[first] * sizeof(std::uint64_t), words.size() * sizeof(std::uint64_t),
                words.data());
  }
  return recoded;
}

}  // namespace

PreparedSurface prepared_surface(const TextureSet& set, bool coded) {
  const Soup& soup = set.soup;
  PreparedSurface made;
  made.source = set;
  // Leaves out faces without opaque texels.
  const std::vector<std::uint8_t> shows = faces_with_opaque_texels(set);
  auto faces = std::make_shared<std::vector<Face>>();
  for (std::size_t f = 0; f < shows.size(); ++f)
    if (shows[f] != 0) faces->push_back(soup.faces()[f]);
  made.shown.nearby = spatial_order(soup, *faces);
  made.shown.faces = std::move(faces);
  const auto packing = std::make_shared<const TexelPacking>(pack_texels(set, shows));
  made.packing = packing;
  if (coded) made.coded = code_if_worthwhile(*packing, *set.texels);
  made.vertices.resize(soup.uvs().size());
  const double width = set.texels->width(), height = set.texels->height();
  tbb::parallel_for(std::size_t{0}, made.vertices.size(), [&](std::size_t v) {
    const Vec2& uv = soup.uvs()[v];
    SurfaceVertex& vertex = made.vertices[v];
    vertex = {glm::vec2(uv.x() * width, (1 - uv.y()) * height), {}, {}, {}};
    const std::uint32_t number = packing->rect_of_vertex[v];
    if (number == packing->rects.size()) {
      if (!packing->whole || made.coded) return;
      // The whole texture is resident, so the vertex can use its own texels.
      vertex.last_texel = glm::u16vec2(packing->width - 1, packing->height - 1);
      return;
    }
    const PackedRect& rect = packing->rects[number];
    vertex.first_texel = glm::u16vec2(rect.x, rect.y);
    vertex.last_texel = glm::u16vec2(rect.x + rect.width - 1, rect.y + rect.height - 1);
    const std::uint32_t first_block = made.coded ? made.coded->first_block[number] : 0;
    vertex.place =
        made.coded ? glm::u16vec2(first_block & 0xffffU, first_block >> 16) : glm::u16vec2(rect.place_x, rect.place_y);
  });
  return made;
}

GpuSurface begin_upload(PreparedSurface made) {
  GpuSurface surface;
  // Indices are uploaded as GL_ARRAY_BUFFER, because an element buffer would need a vertex array.
  glBindVertexArray(0);
  surface.vertices =
      gl::make_buffer(GL_ARRAY_BUFFER, made.vertices.data(), made.vertices.size() * sizeof(SurfaceVertex));
  surface.indices = gl::make_buffer(GL_ARRAY_BUFFER, made.shown.faces->data(), made.shown.faces->size() * sizeof(Face));
  if (made.coded)
    surface.coded = begin_upload(std::move(*made.coded));
  else
    surface.texels = gl::make_texture(GL_RG32UI, made.packing->width, made.packing->height, sizeof(Texel));
  surface.opacity_source = made.source.texels;
  surface.source = std::move(made.source);
  surface.shown = std::move(made.shown);
  surface.packing = std::move(made.packing);
  return surface;
}

bool upload_next_slice(GpuSurface& surface) {
  if (surface.coded) {
    surface.uploaded = upload_some(*surface.coded);
    return surface.uploaded >= 1;
  }
  const TexelPacking& packing = *surface.packing;
  const int count = std::min(band, packing.height - surface.rows_uploaded);
  if (count > 0) {
    std::vector<Texel> rows;
    if (!surface.reading) surface.reading = std::make_unique<const TexelReader>(*surface.source.texels);
    fill_packed_rows(packing, *surface.reading, surface.rows_uploaded, count, rows);
    glBindTexture(GL_TEXTURE_2D, surface.texels.name());
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, surface.rows_uploaded, packing.width, count, GL_RG_INTEGER, GL_UNSIGNED_INT,
                    rows.data());
    surface.rows_uploaded += count;
  }
  surface.uploaded = static_cast<double>(surface.rows_uploaded) / packing.height;
  if (surface.rows_uploaded < packing.height) return false;
  surface.reading.reset();
  return true;
}

bool is_reusable_for(const std::shared_ptr<const FeatureTexture>& opacity_source, const TextureSet& source,
                     const TextureSet& set) {
  return source.soup.shared_uvs() == set.soup.shared_uvs() && source.soup.shared_faces() == set.soup.shared_faces() &&
         opacity_source->width() == set.texels->width() && opacity_source->height() == set.texels->height() &&
         !any_newly_opaque(*opacity_source, *set.texels);
}

std::uint64_t reuse_surface(GpuSurface& surface, const TextureSet& set) {
  const FeatureTexture &before = *surface.source.texels, &after = *set.texels;
  const std::vector<std::uint8_t> changed = changed_tiles(before, after);
  const TexelReader texels(after);
  if (surface.coded) {
    const std::vector<PackedRect>& rects = surface.packing->rects;
    surface.source = set;
    if (const auto recoded = recode_changed_rects(*surface.coded, rects, texels, after.tile_columns(), changed))
      return *recoded;
    // The indices of blocks stay the same, so that the vertices remain valid.
    surface.coded = begin_upload(coded(rects, after));
    while (upload_some(*surface.coded) < 1) {
    }
    return area_of(rects);
  }
  glBindTexture(GL_TEXTURE_2D, surface.texels.name());
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
