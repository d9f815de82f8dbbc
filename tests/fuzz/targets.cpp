#include "tests/fuzz/targets.h"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "editor/script/script.h"
#include "editor/studies/representations/npz.h"
#include "editor/studies/representations/plenoctree_files.h"
#include "editor/studies/representations/snerg_files.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/formats/cameras/camera_json.h"
#include "mesh_ops/formats/cameras/coco_masks.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/mobilenerf/baked_positions_file.h"
#include "mesh_ops/formats/mobilenerf/mlp_json.h"
#include "mesh_ops/formats/mobilenerf/obj.h"
#include "mesh_ops/formats/mobilenerf/rotations_file.h"
#include "mesh_ops/formats/mobilenerf/rotations_json.h"
#include "mesh_ops/formats/nerf2mesh/nerf2mesh_mlp.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake::fuzz {

namespace {

// A small scene for edits.
Scene small_scene() {
  auto object = std::make_shared<BakedObject>();
  object->sets.push_back(
      {Soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0.1, 0.1}, {0.9, 0.1}, {0.1, 0.9}, {0.9, 0.9}},
            {{0, 1, 2}, {1, 3, 2}}),
       std::make_shared<const FeatureTexture>(FeatureTexture::from_rows(4, 4, AlphaCode::halved, [](int, Texel*) {}))});
  Node node;
  node.name = "a";
  node.object = object;
  return with_added({}, node, NodeId::none, 0);
}

// A side file with a correct checksum, so that fuzzing reaches the code behind it.
std::string side_file(std::string_view mark, std::string_view counted) {
  const std::uint64_t hash = content_hash(counted);
  std::string file(mark);
  file.append("\1\0\0\0", 4);
  for (int k = 0; k < 8; ++k) file += static_cast<char>(hash >> (8 * k) & 0xFF);
  return file.append(counted);
}

}  // namespace

void read_obj_bytes(std::string_view bytes) {
  try {
    const ObjMesh mesh = read_obj(bytes, "fuzz.obj");
    const ObjMesh back = read_obj(write_obj(mesh.positions, mesh.uvs, mesh.faces, 0, mesh.faces.size()), "back.obj");
    if (back.faces.size() != mesh.faces.size()) std::abort();
  } catch (const Error&) {
  }
}

void read_json_bytes(std::string_view bytes) {
  try {
    const MlpFile mlp = read_mlp_json(bytes, "fuzz.json");
    if (!(read_mlp_json(write_mlp_json(mlp), "back.json").decoder == mlp.decoder)) std::abort();
  } catch (const Error&) {
  }
  try {
    std::vector<TextureSet> sets = small_scene().roots[0]->object->sets;
    read_rotations_json(bytes, "turns.json", sets);
  } catch (const Error&) {
  }
  try {
    std::vector<TextureSet> sets = small_scene().roots[0]->object->sets;
    read_rotations(side_file("rebaketn", bytes), "turns.bin", sets);
  } catch (const Error&) {
  }
  try {
    std::vector<TextureSet> sets = small_scene().roots[0]->object->sets;
    read_baked_positions(side_file("rebakebp", bytes), "baked.bin", 2, sets);
  } catch (const Error&) {
  }
  try {
    read_camera_json(nlohmann::json::parse(bytes));
  } catch (const Error&) {
  } catch (const nlohmann::json::exception&) {
  }
}

namespace {

// A folder for readers of files, removed at exit.
class Workplace {
 public:
  Workplace() : path_(std::filesystem::temp_directory_path() / fmt::format("rebake-fuzz-{}", ::getpid())) {
    for (const char* name : {"text", "binary"}) std::filesystem::create_directories(path_ / name);
  }
  ~Workplace() { std::filesystem::remove_all(path_); }
  std::filesystem::path with(const std::string& name, std::string_view bytes) const {
    std::ofstream(path_ / name, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

// Cameras that were read have views; those that are written are read back.
void use(const CameraFormat& format, const std::filesystem::path& path) {
  try {
    std::vector<std::string> notes;
    const std::vector<PhotoCamera> cameras = format.read(path, notes);
    views_of(cameras, notes);
    if (format.write != nullptr) format.write(cameras);
  } catch (const Error&) {
  }
}

}  // namespace

void read_camera_bytes(std::string_view bytes) {
  static const Workplace place;
  for (const char* format : {"transforms", "nerfstudio_path", "ngp_path"})
    use(camera_format_named(format), place.with("a.json", bytes));
  use(camera_format_named("poses_bounds"), place.with("a.npy", bytes));
  try {
    PhotoCamera camera;
    camera.name = "a.png";
    camera.width = camera.height = 64;
    const CocoMasks masks(place.with("coco.json", bytes), {camera});
    if (masks.has(0)) masks.mask(0);
  } catch (const Error&) {
  }
  // The first byte states the length of COLMAP's cameras; its images follow.
  if (bytes.empty()) return;
  const std::size_t length = std::min<std::size_t>(static_cast<unsigned char>(bytes[0]), bytes.size() - 1);
  for (const auto& [folder, extension] : {std::pair("text", ".txt"), {"binary", ".bin"}}) {
    place.with(fmt::format("{}/cameras{}", folder, extension), bytes.substr(1, length));
    const auto images = place.with(fmt::format("{}/images{}", folder, extension), bytes.substr(1 + length));
    use(camera_format_named("colmap"), images.parent_path());
  }
}

void read_mesh_bytes(std::string_view bytes) {
  static const Workplace place;
  place.with("a.mtl", bytes);
  for (const char* name : {"a.glb", "a.gltf", "a.ply", "a.obj"}) {
    try {
      const auto path = place.with(name, bytes);
      for (const auto& file : scene_files(path)) static_cast<void>(file);
      read_any(path, Axes::y_up);
    } catch (const Error&) {
    }
  }
  try {
    const Nerf2MeshMlp mlp = read_nerf2mesh_mlp(bytes, "mlp.json");
    if (!(read_nerf2mesh_mlp(write_nerf2mesh_mlp(mlp), "back.json").decoder == mlp.decoder)) std::abort();
  } catch (const Error&) {
  }
}

void read_volume_bytes(std::string_view bytes) {
  static const Workplace place;
  try {
    read_npz(place.with("a.npz", bytes));
    read_plenoctree(place.with("a.npz", bytes));
  } catch (const Error&) {
  }
  try {
    place.with("scene_params.json", bytes);
    read_snerg(place.with("scene_params.json", bytes).parent_path());
  } catch (const Error&) {
  }
}

void read_script_bytes(std::string_view bytes) {
  Scene scene = small_scene();
  std::size_t begin = 0;
  while (begin <= bytes.size()) {
    const std::size_t end = std::min(bytes.find('\n', begin), bytes.size());
    try {
      const auto line = read_line(bytes.substr(begin, end - begin));
      const ScriptCommand command = read_command(with_variables(line, {{"name", "a"}}), scene);
      // No access to files: actions and edits that read files are parsed, but not executed.
      if (const Edit* edit = std::get_if<Edit>(&command); edit != nullptr && edit->type().source_field == nullptr)
        scene = rebake::apply(scene, *edit).scene;
    } catch (const Error&) {
    } catch (const nlohmann::json::exception&) {
    }
    begin = end + 1;
  }
}

}  // namespace rebake::fuzz
