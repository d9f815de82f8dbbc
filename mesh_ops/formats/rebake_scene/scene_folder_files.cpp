#include "mesh_ops/formats/rebake_scene/scene_folder_files.h"

#include <nlohmann/json.hpp>

#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/mobilenerf/baked_files.h"

namespace rebake {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

json read_json(const fs::path& file) { return json::parse(read_file(file), nullptr, false); }

}  // namespace

bool has_scene_json(const fs::path& folder) {
  const json scene = read_json(folder / "scene.json");
  return scene.is_object() && scene.contains("rebake_scene");
}

std::set<std::string> object_folders(const fs::path& folder) {
  std::set<std::string> names;
  if (!fs::exists(folder / "scene.json")) return names;
  const json scene = read_json(folder / "scene.json");
  if (!scene.is_object() || !scene.contains("rebake_scene")) return names;
  std::vector<const json*> open{&scene};
  while (!open.empty()) {
    const json& value = *open.back();
    open.pop_back();
    for (const char* key : {"nodes", "children", "bodies"})
      if (value.is_object() && value.contains(key) && value.at(key).is_array())
        for (const json& child : value.at(key)) open.push_back(&child);
    if (value.is_object() && value.contains("folder") && value.at("folder").is_string())
      names.insert(value.at("folder").get<std::string>());
  }
  return names;
}

std::vector<fs::path> scene_folder_files(const fs::path& folder) {
  std::vector<fs::path> files{"scene.json"};
  for (const std::string& name : object_folders(folder)) {
    const fs::path object = fs::path(name).lexically_normal();
    for (const fs::path& file : baked_files(folder / object)) files.push_back(object / file);
  }
  return files;
}

}  // namespace rebake
