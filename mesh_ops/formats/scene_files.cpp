#include "mesh_ops/formats/scene_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/baked_folder.h"

namespace rebake {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

// Files that Rebake adds to a MobileNeRF folder.
constexpr std::array<std::string_view, 3> sidecar_names{"turns.bin", "turns.json", "baked.bin"};

// Removes leading digits. Returns their number.
std::size_t skip_digits(std::string_view& text) {
  const std::size_t count = std::min(text.find_first_not_of("0123456789"), text.size());
  text.remove_prefix(count);
  return count;
}

// The object folders that scene.json in a folder names; empty if there is no such file.
std::set<std::string> named_folders(const fs::path& folder) {
  std::set<std::string> names;
  if (!fs::exists(folder / "scene.json")) return names;
  const json scene = json::parse(read_file(folder / "scene.json"), nullptr, false);
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

// Adds the existing files of one MobileNeRF folder.
void add_baked_files(const fs::path& root, const fs::path& folder, std::vector<fs::path>& files) {
  const auto add = [&](const std::string& name) {
    if (!fs::exists(root / folder / name)) return false;
    files.push_back(folder / name);
    return true;
  };
  if (!add("mlp.json")) return;
  for (const std::string_view name : sidecar_names) add(std::string(name));
  const json mlp = json::parse(read_file(root / folder / "mlp.json"), nullptr, false);
  const bool unsplit = !mlp.is_object() || !mlp.contains("obj_num");
  // All sets that reading would find, whatever mlp.json says.
  const std::size_t said = !unsplit && mlp.at("obj_num").is_number() && mlp.at("obj_num") > 0
                               ? static_cast<std::size_t>(std::min(mlp.at("obj_num").get<double>(), 1e6))
                               : 1;
  const std::size_t sets = unsplit ? 1 : count_texture_sets(root / folder, said);
  const Layout naming = unsplit ? Layout::unsplit : Layout::split;
  for (std::size_t set = 0; set < sets; ++set) {
    add(geometry_name(naming, set, 0));
    if (!unsplit)
      for (std::size_t chunk = 0; add(geometry_name(Layout::chunked, set, chunk));) ++chunk;
    for (const int image : {0, 1}) add(feature_name(naming, set, image));
  }
}

}  // namespace

bool is_format_file_name(const std::string& name) {
  if (name == "mlp.json" || name == "scene.json" || std::ranges::find(sidecar_names, name) != sidecar_names.end())
    return true;
  std::string_view rest = name;
  if (!rest.starts_with("shape")) return false;
  rest.remove_prefix(5);
  skip_digits(rest);
  if (rest == ".pngfeat0.png" || rest == ".pngfeat1.png" || rest == ".obj") return true;
  if (!rest.starts_with('_')) return false;
  rest.remove_prefix(1);
  return skip_digits(rest) > 0 && rest == ".obj";
}

fs::path scene_folder_of(const fs::path& path) {
  if (path.filename() != "scene.json") return path;
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

std::vector<fs::path> scene_files(const fs::path& folder) {
  std::vector<fs::path> files;
  if (fs::exists(folder / "scene.json")) {
    files.emplace_back("scene.json");
    for (const std::string& name : named_folders(folder))
      add_baked_files(folder, fs::path(name).lexically_normal(), files);
  } else {
    add_baked_files(folder, {}, files);
  }
  std::sort(files.begin(), files.end(),
            [](const fs::path& a, const fs::path& b) { return a.generic_string() < b.generic_string(); });
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

std::uint64_t folder_hash(const fs::path& path) {
  const fs::path folder = scene_folder_of(path);
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw FileError(path, "does not exist, or is not a folder");
  std::string all;
  for (const fs::path& file : scene_files(folder))
    all += fmt::format("{} {:016x}\n", file.generic_string(), content_hash(read_file(folder / file)));
  return content_hash(all);
}

namespace {

bool parses_with(const fs::path& file, const char* key) {
  const json read = json::parse(read_file(file), nullptr, false);
  return read.is_object() && read.contains(key);
}

}  // namespace

void refuse_foreign_content(const fs::path& folder) {
  const std::set<std::string> own = named_folders(folder);
  const auto refuse = [&](const fs::path& path) {
    throw FileError(folder, fmt::format("contains \"{}\", which is not part of its scene; choose a new or empty folder",
                                        path.lexically_relative(folder).string()));
  };
  // The files must also have the contents of a scene, not only the names.
  const bool is_scene = fs::exists(folder / "scene.json"), is_baked = fs::exists(folder / "mlp.json");
  if (is_scene && !parses_with(folder / "scene.json", "rebake_scene")) refuse(folder / "scene.json");
  if (is_baked && !parses_with(folder / "mlp.json", "0_weights")) refuse(folder / "mlp.json");
  if (!is_scene && !is_baked && !fs::is_empty(folder)) refuse(fs::directory_iterator(folder)->path());
  std::error_code error;
  for (auto it = fs::recursive_directory_iterator(folder, error); !error && it != fs::recursive_directory_iterator();
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (it->is_symlink()) refuse(it->path());
    if (it->is_directory() ? it.depth() > 0 || !own.contains(name) : !is_format_file_name(name)) refuse(it->path());
  }
  if (error) throw FileError(folder, "cannot be read: " + error.message());
}

}  // namespace rebake
