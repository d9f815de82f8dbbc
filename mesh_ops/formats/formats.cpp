#include "mesh_ops/formats/formats.h"

#include <algorithm>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/baked_folder.h"
#include "mesh_ops/formats/scene_folder.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

Scene read_mobilenerf(const fs::path& folder, Axes axes, const Progress& progress) {
  Node node;
  node.name = folder_title(folder);
  node.object = read_baked_folder(folder, axes, progress);
  return with_added({}, node, NodeId::none, 0);
}

Scene read_rebake(const fs::path& folder, Axes /*stated in scene.json*/, const Progress& progress) {
  return read_scene_folder(folder, progress);
}

ExportReport write_rebake(const Scene& scene, const fs::path& folder, const ExportOptions& options,
                          const Progress& progress) {
  if (options.layout)
    throw FieldError("layout", "does not apply to Rebake scenes: every object keeps its own; leave it out");
  ExportReport report;
  report.preserves_scene = true;
  report.notes = save_scene_folder(scene, folder, options.sources, progress);
  return report;
}

// The first format that recognises a folder reads it.
constexpr Format table[] = {
    {"rebake", "Rebake scene", [](const fs::path& folder) { return fs::exists(folder / "scene.json"); }, read_rebake,
     write_rebake},
    {"mobilenerf", "MobileNeRF", [](const fs::path& folder) { return fs::exists(folder / "mlp.json"); },
     read_mobilenerf, export_scene},
};

}  // namespace

std::string folder_title(const fs::path& path) {
  fs::path normal = absolute_path(path);
  if (normal.filename() == "scene.json") normal = normal.parent_path();
  return normal.filename().string();
}

std::span<const Format> formats() { return table; }

const Format& format_named(const std::string& name) {
  std::string known;
  for (const Format& format : formats()) {
    if (format.name == name) return format;
    known += (known.empty() ? "" : ", ") + std::string(format.name);
  }
  throw FieldError("format", "\"" + name + "\" is not known (known: " + known + ")");
}

Scene read_any(const fs::path& path, Axes axes, const Progress& progress) {
  // A path to scene.json stands for its folder.
  const fs::path folder =
      path.filename() == "scene.json" ? (path.has_parent_path() ? path.parent_path() : fs::path(".")) : path;
  if (!fs::exists(folder)) throw FileError(folder, "does not exist");
  if (!fs::is_directory(folder)) throw FileError(folder, "is not a folder");
  for (const Format& format : formats())
    if (format.recognises(folder)) return format.read(folder, axes, progress);
  throw FileError(folder, "contains neither mlp.json (a MobileNeRF folder) nor scene.json (a Rebake scene)");
}

std::vector<std::string> assumptions_of(const Scene& scene) {
  std::vector<std::string> all;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object || !placed.node->object->origin) continue;
    for (const std::string& one : placed.node->object->origin->assumptions)
      if (std::find(all.begin(), all.end(), one) == all.end()) all.push_back(one);
  }
  return all;
}

}  // namespace rebake
