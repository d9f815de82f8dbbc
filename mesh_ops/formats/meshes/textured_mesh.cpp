#include "mesh_ops/formats/meshes/textured_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/images/rgba_png.h"
#include "mesh_ops/scene/scene_light.h"

namespace rebake {

namespace {

// Display values of all bytes of a channel, multiplied by a linear factor.
std::array<std::uint8_t, 256> scaled(double factor) {
  std::array<std::uint8_t, 256> table{};
  for (std::size_t v = 0; v < table.size(); ++v) {
    const double value = static_cast<double>(v) / 255;
    const double out = factor == 1 ? value : to_display(std::clamp(factor * to_linear(value), 0.0, 1.0));
    table[v] = static_cast<std::uint8_t>(std::lround(255 * out));
  }
  return table;
}

std::shared_ptr<const FeatureTexture> texture_of(const MeshMaterial& material, int columns, int rows) {
  const ColorImage& image = *material.image;
  std::array<std::array<std::uint8_t, 256>, 3> colors;
  for (std::size_t c = 0; c < 3; ++c) colors[c] = scaled(material.factor[c]);
  const double least_alpha = material.cutoff ? 255 * *material.cutoff : -1;
  return std::make_shared<const FeatureTexture>(
      FeatureTexture::from_rows(image.width * columns, image.height * rows, AlphaCode::plain, [&](int y, Texel* row) {
        for (int x = 0; x < image.width * columns; ++x) {
          const std::uint8_t* pixel = image.pixel(x % image.width, y % image.height);
          if (pixel[3] * material.factor[3] < least_alpha) {
            row[x] = empty_texel(AlphaCode::plain);
            continue;
          }
          row[x] = {{255, colors[0][pixel[0]], colors[1][pixel[1]], colors[2][pixel[2]]}, {0, 0, 0, 255}};
        }
      }));
}

// Number of tiles of a repeating image that a face spans along an axis, counted from the tile of its lowest corner.
int tiles_of(const TexturedMesh& mesh, const Face& face, Eigen::Index axis) {
  const auto [low, high] = std::minmax({mesh.uvs[face[0]][axis], mesh.uvs[face[1]][axis], mesh.uvs[face[2]][axis]});
  const double tiles = std::ceil(high - std::floor(low));
  return static_cast<int>(std::clamp(tiles, 1.0, 1e6));
}

// Moves each face into the first tiles along the axes that repeat, and scales its UVs to columns × rows tiles.
void wrap(TexturedMesh& mesh, int columns, int rows) {
  std::map<std::tuple<std::uint32_t, double, double>, std::uint32_t> known;
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;
  for (Face& face : mesh.faces) {
    Vec2 tile = mesh.uvs[face[0]];
    for (const std::uint32_t vertex : face) tile = tile.cwiseMin(mesh.uvs[vertex]);
    tile = tile.array().floor();
    for (const Eigen::Index axis : {0, 1})
      if (!mesh.material.repeats[static_cast<std::size_t>(axis)]) tile[axis] = 0;
    for (std::uint32_t& vertex : face) {
      const auto [it, fresh] =
          known.try_emplace({vertex, tile.x(), tile.y()}, static_cast<std::uint32_t>(positions.size()));
      if (fresh) {
        positions.push_back(mesh.positions[vertex]);
        uvs.push_back((mesh.uvs[vertex] - tile).cwiseQuotient(Vec2(columns, rows)));
      }
      vertex = it->second;
    }
  }
  mesh.positions = std::move(positions);
  mesh.uvs = std::move(uvs);
}

TextureSet set_of(TexturedMesh mesh, const std::filesystem::path& file, std::vector<std::string>& assumptions) {
  int columns = 1, rows = 1;
  const bool outside = std::any_of(mesh.uvs.begin(), mesh.uvs.end(),
                                   [](const Vec2& uv) { return uv.minCoeff() < 0 || uv.maxCoeff() > 1; });
  const auto [repeats_u, repeats_v] = mesh.material.repeats;
  if ((repeats_u || repeats_v) && outside) {
    for (const Face& face : mesh.faces) {
      if (repeats_u) columns = std::max(columns, tiles_of(mesh, face, 0));
      if (repeats_v) rows = std::max(rows, tiles_of(mesh, face, 1));
    }
    const ColorImage& image = *mesh.material.image;
    if (columns > largest_png_side / image.width || rows > largest_png_side / image.height ||
        (columns * rows > 1 && std::int64_t{columns} * image.width * rows * image.height > largest_repeated))
      throw FileError(file, fmt::format("material \"{}\": its image repeats {}×{} times within a triangle, which needs "
                                        "too large a texture: cut the triangles, or bake the texture",
                                        mesh.material.name, columns, rows));
    if (columns * rows > 1)
      assumptions.push_back(
          fmt::format("material \"{}\": its image is repeated {}×{} times in the texture, because "
                      "triangles span that many repeats",
                      mesh.material.name, columns, rows));
    wrap(mesh, columns, rows);
  }
  const auto texels = texture_of(mesh.material, columns, rows);
  return {Soup(std::move(mesh.positions), std::move(mesh.uvs), std::move(mesh.faces)), texels};
}

}  // namespace

namespace {

// Joins meshes without images to one, whose image has a pixel for each of their colours.
void share_palette(std::vector<TexturedMesh>& meshes) {
  TexturedMesh all;
  ColorImage palette{0, 1, {}};
  std::vector<std::uint32_t> color_of;  // per vertex
  for (TexturedMesh& mesh : meshes) {
    if (mesh.material.image || mesh.faces.empty()) continue;
    const auto first = static_cast<std::uint32_t>(all.positions.size());
    all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
    color_of.resize(all.positions.size(), static_cast<std::uint32_t>(palette.width));
    for (const Face& face : mesh.faces) all.faces.push_back({face[0] + first, face[1] + first, face[2] + first});
    for (std::size_t c = 0; c < 3; ++c)
      palette.rgba.push_back(
          static_cast<std::uint8_t>(std::lround(255 * to_display(std::clamp(mesh.material.factor[c], 0.0, 1.0)))));
    const bool is_hole = mesh.material.cutoff && mesh.material.factor[3] < *mesh.material.cutoff;
    palette.rgba.push_back(is_hole ? 0 : 255);
    ++palette.width;
    mesh.faces.clear();
  }
  if (all.faces.empty()) return;
  // Rows of at most 1024 pixels.
  constexpr int widest = 1024;
  const int colors = palette.width;
  palette.width = std::min(colors, widest);
  palette.height = (colors + palette.width - 1) / palette.width;
  palette.rgba.resize(4 * static_cast<std::size_t>(palette.width) * static_cast<std::size_t>(palette.height), 255);
  for (const std::uint32_t color : color_of) {
    const std::uint32_t columns = static_cast<unsigned>(palette.width), column = color % columns, row = color / columns;
    all.uvs.emplace_back((column + 0.5) / palette.width, 1 - (row + 0.5) / palette.height);
  }
  all.material.image = std::make_shared<const ColorImage>(std::move(palette));
  all.material.cutoff = 0.5;
  meshes.push_back(std::move(all));
}

}  // namespace

std::shared_ptr<BakedObject> object_of_meshes(std::vector<TexturedMesh> meshes, const std::filesystem::path& file,
                                              std::vector<std::string>& assumptions) {
  auto object = std::make_shared<BakedObject>();
  object->decoder = std::make_shared<const Decoder>(diffuse_decoder());
  object->axes = Axes::forward;
  object->dialect.alpha = AlphaCode::plain;
  for (const TexturedMesh& mesh : meshes)
    for (const Vec3& p : mesh.positions)
      if (!p.allFinite()) throw FileError(file, "has positions that are not finite, perhaps by large transforms");
  share_palette(meshes);
  for (TexturedMesh& mesh : meshes)
    if (!mesh.faces.empty()) object->sets.push_back(set_of(std::move(mesh), file, assumptions));
  if (object->sets.empty()) throw FileError(file, "has no triangles");
  return object;
}

}  // namespace rebake
