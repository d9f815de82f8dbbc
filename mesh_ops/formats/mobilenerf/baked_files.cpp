#include "mesh_ops/formats/mobilenerf/baked_files.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>

#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/mobilenerf/baked_folder.h"

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
  const json mlp = json::parse(read_file(folder / "mlp.json"), nullptr, false);
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
  const json mlp = json::parse(read_file(folder / "mlp.json"), nullptr, false);
  const bool unsplit = !mlp.is_object() || !mlp.contains("obj_num");
  // All sets that reading would find, whatever mlp.json says.
  const std::size_t said = !unsplit && mlp.at("obj_num").is_number() && mlp.at("obj_num") > 0
                               ? static_cast<std::size_t>(std::min(mlp.at("obj_num").get<double>(), 1e6))
                               : 1;
  const std::size_t sets = unsplit ? 1 : count_texture_sets(folder, said);
  const Layout naming = unsplit ? Layout::unsplit : Layout::split;
  for (std::size_t set = 0; set < sets; ++set) {
    add(geometry_name(naming, set, 0));
    if (!unsplit)
      for (std::size_t chunk = 0; add(geometry_name(Layout::chunked, set, chunk));) ++chunk;
    for (const int image : {0, 1}) add(feature_name(naming, set, image));
  }
  return files;
}

}  // namespace rebake
