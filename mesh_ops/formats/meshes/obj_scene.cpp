#include "mesh_ops/formats/meshes/obj_scene.h"

#include <fmt/format.h>

#include <array>
#include <map>
#include <optional>
#include <sstream>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/meshes/beside.h"
#include "mesh_ops/formats/meshes/textured_mesh.h"
#include "mesh_ops/formats/mobilenerf/obj.h"
#include "mesh_ops/scene/scene_light.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

struct Material {
  std::array<double, 3> color{1, 1, 1};  // Kd
  std::optional<fs::path> image;         // map_Kd, relative to the OBJ's folder
};

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

// The file name after the options of map_Kd, such as "-s 1 1 1".
std::string name_after_options(std::string text, const fs::path& file) {
  if (text.starts_with('-'))
    throw FileError(file, fmt::format("map_Kd has options (\"{}\"), which are not supported: write the name alone",
                                      text.substr(0, text.find(' '))));
  return text;
}

std::map<std::string, Material> read_mtl(const fs::path& folder, const fs::path& name) {
  std::map<std::string, Material> materials;
  std::istringstream lines(read_file(folder / name));
  Material* material = nullptr;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    std::string rest;
    std::getline(words, rest);
    rest = trimmed(rest);
    if (key == "newmtl") material = &materials[rest];
    if (material == nullptr) continue;
    if (key == "map_Kd" && !rest.empty())
      material->image = path_beside(folder, name_after_options(rest, folder / name), folder / name);
    if (key != "Kd") continue;
    std::istringstream numbers(rest);
    std::array<double, 3> color{};
    if (numbers >> color[0] >> color[1] >> color[2]) material->color = color;
  }
  return materials;
}

// The pictures that an MTL file names with any key, such as map_Bump with options before the name, as far as they
// exist.
std::vector<fs::path> named_pictures(const fs::path& folder, const fs::path& name) {
  std::vector<fs::path> pictures;
  std::istringstream lines(read_file(folder / name));
  for (std::string line; std::getline(lines, line);) {
    std::replace(line.begin(), line.end(), '\\', '/');  // of Windows
    line = trimmed(line);
    if (line.starts_with('#') || line.starts_with("newmtl")) continue;
    for (std::size_t at = line.find_first_of(" \t"); at != std::string::npos; at = line.find_first_of(" \t", at + 1)) {
      const std::string rest = trimmed(line.substr(at));
      std::error_code error;
      if (rest.empty() || !fs::is_regular_file(folder / rest, error)) continue;
      pictures.emplace_back(rest);
      break;
    }
  }
  return pictures;
}

// The material files that a file names. A line may name several; a name may contain blanks if there is such a file.
std::vector<fs::path> library_paths(const fs::path& file, const std::vector<std::string>& lines) {
  const fs::path folder = file.parent_path();
  std::vector<fs::path> paths;
  for (const std::string& line : lines) {
    const fs::path whole = path_beside(folder, line, file);
    if (fs::exists(folder / whole)) {
      paths.push_back(whole);
      continue;
    }
    std::istringstream names(line);
    for (std::string name; names >> name;) paths.push_back(path_beside(folder, name, file));
  }
  return paths;
}

struct ObjFile {
  ObjMesh mesh;
  std::vector<fs::path> libraries;
  std::map<std::string, Material> materials;
};

ObjFile read_with_materials(const fs::path& file) {
  ObjFile read{read_obj(read_file(file), file, {true, true}), {}, {}};
  const fs::path folder = file.parent_path();
  for (const fs::path& name : library_paths(file, read.mesh.libraries)) {
    if (!fs::exists(folder / name)) {
      read.mesh.assumptions.push_back(fmt::format("{} does not exist: its materials are white", name.string()));
      continue;
    }
    read.libraries.push_back(name);
    read.materials.merge(read_mtl(folder, name));
  }
  return read;
}

}  // namespace

std::shared_ptr<const BakedObject> read_obj_object(const fs::path& file) {
  ObjFile read = read_with_materials(file);
  std::vector<TexturedMesh> meshes(read.mesh.materials.size());
  std::map<fs::path, std::shared_ptr<const ColorImage>> images;
  bool takes_kd = false;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    MeshMaterial& material = meshes[m].material;
    material.name = read.mesh.materials[m];
    if (!material.name.empty() && !read.materials.contains(material.name))
      read.mesh.assumptions.push_back(fmt::format("material \"{}\" is not defined: it is white", material.name));
    const Material found = read.materials[material.name];
    if (found.image) {
      auto& image = images[*found.image];
      const fs::path path = file.parent_path() / *found.image;
      if (!image)
        image = std::make_shared<const ColorImage>(
            decode_color_image(read_beside(file.parent_path(), *found.image, file), path));
      material.image = image;
      material.cutoff = 0.5;
    } else {
      takes_kd = takes_kd || found.color != std::array<double, 3>{1, 1, 1};
      for (std::size_t c = 0; c < 3; ++c) material.factor[c] = to_linear(std::clamp(found.color[c], 0.0, 1.0));
    }
  }
  std::vector<std::map<std::uint32_t, std::uint32_t>> numbers(meshes.size());
  for (std::size_t f = 0; f < read.mesh.faces.size(); ++f) {
    const std::uint32_t m = read.mesh.material_of[f];
    TexturedMesh& mesh = meshes[m];
    Face face = read.mesh.faces[f];
    for (std::uint32_t& vertex : face) {
      const auto [it, fresh] = numbers[m].try_emplace(vertex, static_cast<std::uint32_t>(mesh.positions.size()));
      if (fresh) {
        mesh.positions.push_back(read.mesh.positions[vertex]);
        mesh.uvs.push_back(read.mesh.uvs[vertex]);
      }
      vertex = it->second;
    }
    mesh.faces.push_back(face);
  }
  std::vector<std::string> assumptions = std::move(read.mesh.assumptions);
  if (takes_kd) assumptions.emplace_back("Kd is a display colour (Blender writes linear ones, which are darker here)");
  assumptions.emplace_back("y is up; colours are drawn as they are, without light, and with nearest filtering");
  const auto object = object_of_meshes(std::move(meshes), file, assumptions);
  object->origin = origin_of_file(file, "obj", std::move(assumptions));
  return object;
}

std::vector<fs::path> obj_files(const fs::path& file) {
  const ObjFile read = read_with_materials(file);
  std::vector<fs::path> files = read.libraries;
  for (const std::string& name : read.mesh.materials)
    if (const auto found = read.materials.find(name); found != read.materials.end() && found->second.image)
      files.push_back(*found->second.image);
  return files;
}

std::vector<fs::path> obj_unread_files(const fs::path& file) {
  const fs::path folder = file.parent_path();
  std::vector<fs::path> files;
  for (const fs::path& name : library_paths(file, read_obj(read_file(file), file, {true, true}).libraries)) {
    std::error_code error;
    if (fs::is_regular_file(folder / name, error))
      for (fs::path& picture : named_pictures(folder, name)) files.push_back(std::move(picture));
  }
  return files;
}

}  // namespace rebake
