#include "mesh_ops/formats/nerf2mesh/nerf2mesh_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/images/color_image.h"
#include "mesh_ops/formats/mobilenerf/obj.h"
#include "mesh_ops/formats/mobilenerf/source_file.h"
#include "mesh_ops/formats/nerf2mesh/nerf2mesh_mlp.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

constexpr const char* image_extensions[] = {".jpg", ".png"};

std::string mesh_name(int k) { return fmt::format("mesh_{}.obj", k); }
std::string material_name(int k) { return fmt::format("mesh_{}.mtl", k); }

// The name of an image, with the extension that exists. Throws FileError if both do, since they may differ, or none.
std::string image_name(const fs::path& folder, int image, int k) {
  std::optional<std::string> found;
  for (const char* extension : image_extensions) {
    const std::string name = fmt::format("feat{}_{}{}", image, k, extension);
    if (!fs::exists(folder / name)) continue;
    if (found) throw FileError(folder / name, fmt::format("and {} are both there: remove one", *found));
    found = name;
  }
  if (!found) throw FileError(folder / fmt::format("feat{}_{}.jpg", image, k), "does not exist, nor does a .png");
  return *found;
}

std::shared_ptr<const FeatureTexture> joined(const ColorImage& diffuse, const ColorImage& specular) {
  return std::make_shared<const FeatureTexture>(
      FeatureTexture::from_rows(diffuse.width, diffuse.height, AlphaCode::plain, [&](int y, Texel* row) {
        for (int x = 0; x < diffuse.width; ++x) {
          const std::uint8_t* d = diffuse.pixel(x, y);
          const std::uint8_t* s = specular.pixel(x, y);
          row[x] = {{255, d[0], d[1], d[2]}, {s[0], s[1], s[2], 255}};
        }
      }));
}

}  // namespace

Affine nerf2mesh_to_y_up() {
  Affine turn = Affine::Identity();
  turn.linear() << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return turn;
}

bool is_nerf2mesh_folder(const fs::path& folder) {
  return fs::exists(folder / "mlp.json") && fs::exists(folder / mesh_name(0)) && !fs::exists(folder / "scene.json");
}

bool has_nerf2mesh_decoder(const fs::path& folder) { return is_nerf2mesh_mlp(read_file(folder / "mlp.json")); }

std::set<std::string> own_nerf2mesh_files(const fs::path& folder) {
  std::set<std::string> names;
  std::error_code error;
  if (!fs::is_regular_file(folder / "mlp.json", error) || !has_nerf2mesh_decoder(folder)) return names;
  names.merge(names_of_scene(folder, nerf2mesh_files));
  return names;
}

std::vector<fs::path> nerf2mesh_files(const fs::path& folder) {
  std::vector<fs::path> files{"mlp.json"};
  const fs::path name = folder / "mlp.json";
  const int count = read_nerf2mesh_mlp(read_file(name), name).cascade;
  for (int k = 0; k < count; ++k) {
    files.emplace_back(mesh_name(k));
    if (fs::exists(folder / material_name(k))) files.emplace_back(material_name(k));
    for (const int image : {0, 1}) files.emplace_back(image_name(folder, image, k));
  }
  return files;
}

std::shared_ptr<const BakedObject> read_nerf2mesh_folder(const fs::path& folder, const Progress& progress) {
  const std::string text = read_file(folder / "mlp.json");
  Nerf2MeshMlp mlp = read_nerf2mesh_mlp(text, folder / "mlp.json");
  auto object = std::make_shared<BakedObject>();
  auto origin = std::make_shared<Origin>();
  object->decoder = std::make_shared<const Decoder>(std::move(mlp.decoder));
  object->axes = Axes::forward;
  object->dialect.alpha = AlphaCode::plain;
  object->other_members = std::move(mlp.others);
  origin->folder = absolute_path(folder);
  origin->format = nerf2mesh_format;
  origin->dialect = object->dialect;
  origin->mlp = source_file("mlp.json", text);
  origin->decoder = object->decoder;
  origin->obj_num = mlp.cascade;
  for (int k = 0; k < mlp.cascade; ++k) {
    progress.at("reading " + folder.filename().string(), static_cast<double>(k) / mlp.cascade);
    const std::string mesh_text = read_file(folder / mesh_name(k));
    // With names of materials, so that they are not reported as skipped.
    ObjMesh mesh = read_obj(mesh_text, folder / mesh_name(k), {true, false});
    for (const std::string& assumption : mesh.assumptions)
      origin->assumptions.push_back(fmt::format("{}: {}", mesh_name(k), assumption));
    const std::string names[] = {image_name(folder, 0, k), image_name(folder, 1, k)};
    const std::string bytes[] = {read_file(folder / names[0]), read_file(folder / names[1])};
    const ColorImage diffuse = decode_color_image(bytes[0], folder / names[0]),
                     specular = decode_color_image(bytes[1], folder / names[1]);
    if (diffuse.width != specular.width || diffuse.height != specular.height)
      throw FileError(folder / names[1], fmt::format("is {}×{}, but {} is {}×{}", specular.width, specular.height,
                                                     names[0], diffuse.width, diffuse.height));
    if (mesh.faces.empty()) {
      origin->assumptions.push_back(fmt::format("{} has no triangles: it is left out", mesh_name(k)));
      continue;
    }
    TextureSet set{Soup(std::move(mesh.positions), std::move(mesh.uvs), std::move(mesh.faces)),
                   joined(diffuse, specular)};
    origin->sets.push_back({{source_file(mesh_name(k), mesh_text)},
                            source_file(names[0], bytes[0]),
                            source_file(names[1], bytes[1]),
                            set.soup.shared_positions(),
                            set.soup.shared_uvs(),
                            set.soup.shared_faces(),
                            set.texels});
    // Only other programs need the material.
    if (fs::exists(folder / material_name(k)))
      origin->sets.back().geometry.push_back(source_file(material_name(k), read_file(folder / material_name(k))));
    object->sets.push_back(std::move(set));
  }
  if (object->sets.empty()) throw FileError(folder / mesh_name(0), "has no triangles, like all meshes");
  object->origin = origin;
  return object;
}

}  // namespace rebake
