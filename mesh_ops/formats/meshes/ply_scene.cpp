#include "mesh_ops/formats/meshes/ply_scene.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <tuple>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/meshes/beside.h"
#include "mesh_ops/formats/meshes/ply_file.h"
#include "mesh_ops/formats/meshes/textured_mesh.h"
#include "mesh_ops/mesh/polygon.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// Triangles of all polygons, as corner numbers within their polygon.
template <class Visit>
void for_each_triangle(const PlyFile& ply, const fs::path& file, Visit visit) {
  for (std::size_t p = 0; p < ply.polygons.size(); ++p) {
    std::vector<Vec3> corners;
    for (const std::uint32_t vertex : ply.polygons[p]) corners.push_back(ply.positions[vertex]);
    try {
      for (const auto& triangle : cut_polygon(corners).triangles) visit(p, triangle);
    } catch (const FileError&) {
      throw;
    } catch (const Error& error) {
      throw FileError(file, fmt::format("face {}: {}", p, error.what()));
    }
  }
}

Vec2 uv_of(const PlyFile& ply, std::size_t polygon, std::size_t corner) {
  const std::vector<double>& own = ply.polygon_uvs[polygon];
  if (!own.empty()) return {own[2 * corner], own[2 * corner + 1]};
  return ply.uvs.empty() ? Vec2(0, 0) : ply.uvs[ply.polygons[polygon][corner]];
}

// One mesh per image.
std::vector<TexturedMesh> textured(const PlyFile& ply, const fs::path& file) {
  std::vector<TexturedMesh> meshes(ply.images.size());
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    const fs::path name = path_beside(file.parent_path(), ply.images[k], file), image = file.parent_path() / name;
    meshes[k].material.name = ply.images[k];
    meshes[k].material.image =
        std::make_shared<const ColorImage>(decode_color_image(read_beside(file.parent_path(), name, file), image));
    meshes[k].material.cutoff = 0.5;
  }
  std::map<std::tuple<std::size_t, std::uint32_t, double, double>, std::uint32_t> known;
  for_each_triangle(ply, file, [&](std::size_t p, const auto& triangle) {
    TexturedMesh& mesh = meshes[ply.image_of[p]];
    Face face;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = ply.polygons[p][triangle[k]];
      const Vec2 uv = uv_of(ply, p, triangle[k]);
      const auto [it, fresh] = known.try_emplace({ply.image_of[p], vertex, uv.x(), uv.y()},
                                                 static_cast<std::uint32_t>(mesh.positions.size()));
      if (fresh) {
        mesh.positions.push_back(ply.positions[vertex]);
        mesh.uvs.push_back(uv);
      }
      face[k] = it->second;
    }
    mesh.faces.push_back(face);
  });
  return meshes;
}

// One texel per triangle, with the mean colour of its vertices.
TexturedMesh flat_colored(const PlyFile& ply, const fs::path& file) {
  TexturedMesh mesh;
  std::vector<std::array<std::uint8_t, 3>> colors;
  for_each_triangle(ply, file, [&](std::size_t p, const auto& triangle) {
    std::array<double, 3> sum{};
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = ply.polygons[p][triangle[k]];
      mesh.positions.push_back(ply.positions[vertex]);
      for (std::size_t c = 0; c < 3; ++c) sum[c] += ply.colors.empty() ? 1 : ply.colors[vertex][c];
    }
    mesh.faces.push_back({first, first + 1, first + 2});
    std::array<std::uint8_t, 3> color{};
    for (std::size_t c = 0; c < 3; ++c) color[c] = static_cast<std::uint8_t>(std::lround(255 * sum[c] / 3));
    colors.push_back(color);
  });
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(colors.size()))));
  ColorImage image{static_cast<int>(side), static_cast<int>(side), std::vector<std::uint8_t>(4 * side * side, 255)};
  for (std::size_t f = 0; f < colors.size(); ++f) {
    std::copy(colors[f].begin(), colors[f].end(), image.rgba.begin() + static_cast<std::ptrdiff_t>(4 * f));
    const std::size_t column = f % side, row = f / side;
    const Vec2 uv((static_cast<double>(column) + 0.5) / static_cast<double>(side),
                  1 - (static_cast<double>(row) + 0.5) / static_cast<double>(side));
    for (int k = 0; k < 3; ++k) mesh.uvs.push_back(uv);
  }
  mesh.material.image = std::make_shared<const ColorImage>(std::move(image));
  return mesh;
}

}  // namespace

std::shared_ptr<const BakedObject> read_ply_object(const fs::path& file) {
  const PlyFile ply = read_ply(read_file(file), file);
  if (ply.polygons.empty()) throw FileError(file, "has no faces: point clouds are not supported");
  std::vector<std::string> assumptions;
  std::vector<TexturedMesh> meshes;
  if (!ply.images.empty()) {
    meshes = textured(ply, file);
  } else {
    meshes.push_back(flat_colored(ply, file));
    assumptions.emplace_back(ply.colors.empty() ? "has no colours: triangles are white"
                                                : "each triangle has the mean of its vertices' colours");
  }
  assumptions.emplace_back("y is up; colours are drawn as they are, without light, and with nearest filtering");
  const auto object = object_of_meshes(std::move(meshes), file, assumptions);
  object->origin = origin_of_file(file, "ply", std::move(assumptions));
  return object;
}

std::vector<fs::path> ply_files(const fs::path& file) {
  std::vector<fs::path> files;
  for (const std::string& image : read_ply(read_file(file), file).images)
    files.push_back(path_beside(file.parent_path(), image, file));
  return files;
}

}  // namespace rebake
