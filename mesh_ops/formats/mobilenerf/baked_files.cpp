#include "mesh_ops/formats/mobilenerf/baked_files.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/mobilenerf/baked_layout.h"
#include "mesh_ops/formats/mobilenerf/baked_positions_file.h"
#include "mesh_ops/formats/mobilenerf/json_text.h"
#include "mesh_ops/formats/mobilenerf/rotations_file.h"
#include "mesh_ops/formats/mobilenerf/source_file.h"

namespace rebake {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

// Files that Rebake adds to a MobileNeRF folder.
constexpr std::array<std::string_view, 3> sidecar_names{"turns.bin", "turns.json", "baked.bin"};

// Written beside a trained scene. A file of another program may have this name.
constexpr const char* training_report = "rebake_training.json";

// Removes leading digits. Returns their number.
std::size_t skip_digits(std::string_view& text) {
  const std::size_t count = std::min(text.find_first_not_of("0123456789"), text.size());
  text.remove_prefix(count);
  return count;
}

}  // namespace

bool is_baked_file_name(const std::string& name) {
  if (name == "mlp.json" || std::ranges::find(sidecar_names, name) != sidecar_names.end()) return true;
  std::string_view rest = name;
  if (!rest.starts_with("shape")) return false;
  rest.remove_prefix(5);
  skip_digits(rest);
  if (rest == ".pngfeat0.png" || rest == ".pngfeat1.png" || rest == ".obj") return true;
  if (!rest.starts_with('_')) return false;
  rest.remove_prefix(1);
  return skip_digits(rest) > 0 && rest == ".obj";
}

bool has_baked_decoder(const fs::path& folder) {
  const json mlp = json::parse(without_trailing_commas(read_file(folder / "mlp.json")).text, nullptr, false);
  return mlp.is_object() && mlp.contains("0_weights");
}

std::vector<fs::path> baked_files(const fs::path& folder) {
  std::vector<fs::path> files;
  const auto add = [&](const std::string& name) {
    if (!fs::exists(folder / name)) return false;
    files.emplace_back(name);
    return true;
  };
  if (!add("mlp.json")) return files;
  for (const std::string_view name : sidecar_names) add(std::string(name));
  const std::string text = read_file(folder / "mlp.json");
  const json mlp = json::parse(without_trailing_commas(text).text, nullptr, false);
  std::optional<int> obj_num;
  if (mlp.is_object() && mlp.contains("obj_num"))
    obj_num = mlp.at("obj_num").is_number() && mlp.at("obj_num") > 0
                  ? static_cast<int>(std::min(mlp.at("obj_num").get<double>(), 1e6))
                  : 1;
  for (const BakedLayout::Set& set : find_baked_layout(folder, obj_num).sets) {
    files.insert(files.end(), set.geometry.begin(), set.geometry.end());
    for (const std::string& texture : set.textures)
      if (!texture.empty()) files.emplace_back(texture);
  }
  return files;
}

namespace {

// Whether a file of a sidecar's name has its content.
bool is_sidecar(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  const std::string bytes = read_file(file);
  if (file.extension() != ".json")
    return bytes.starts_with(file.filename() == "baked.bin" ? positions_mark : rotations_mark);
  const json text = json::parse(bytes, nullptr, false);
  return text.is_object() && text.contains("rebake_turns");
}

// Whether a file is the report of the training that wrote the scene in the folder.
bool is_report_of(const fs::path& folder, const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  const json report = json::parse(read_file(file), nullptr, false);
  if (!report.is_object() || report.value("software", json()) != "Rebake") return false;
  try {
    return report.value("scene", json()) == hash_text(baked_hash(folder));
  } catch (const FileError&) {
    return false;  // the scene is damaged
  }
}

}  // namespace

std::uint64_t baked_hash(const fs::path& folder) {
  std::vector<fs::path> files = baked_files(folder);
  std::sort(files.begin(), files.end());
  std::string all;
  for (const fs::path& file : files)
    all += file.generic_string() + " " + hash_text(content_hash(read_file(folder / file))) + "\n";
  return content_hash(all);
}

std::set<std::string> own_baked_files(const fs::path& folder) {
  std::set<std::string> names;
  std::error_code error;
  if (is_report_of(folder, folder / training_report)) names.insert(training_report);
  if (fs::is_regular_file(folder / "mlp.json", error) && has_baked_decoder(folder))
    names.merge(names_of_scene(folder, baked_files));
  for (const std::string_view name : sidecar_names) {
    names.erase(std::string(name));
    if (is_sidecar(folder / name)) names.emplace(name);
  }
  return names;
}

}  // namespace rebake
