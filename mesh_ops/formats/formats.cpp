#include "mesh_ops/formats/formats.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/gltf_features.h"
#include "mesh_ops/formats/meshes/gltf_scene.h"
#include "mesh_ops/formats/meshes/obj_scene.h"
#include "mesh_ops/formats/meshes/ply_scene.h"
#include "mesh_ops/formats/mobilenerf/baked_files.h"
#include "mesh_ops/formats/nerf2mesh/nerf2mesh_folder.h"
#include "mesh_ops/formats/rebake_scene/scene_folder.h"
#include "mesh_ops/formats/rebake_scene/scene_folder_files.h"
#include "mesh_ops/formats/scene_files.h"
#include "mesh_ops/formats/write_gltf.h"
#include "mesh_ops/motion/scene_at.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

Scene read_mobilenerf(const fs::path& folder, const ReadOptions& options, const Progress& progress) {
  Node node;
  node.name = folder_title(folder);
  node.object = read_baked_folder(folder, options, progress);
  return with_added({}, node, NodeId::none, 0);
}

Scene read_rebake(const fs::path& folder, const ReadOptions& /*stated in scene.json*/, const Progress& progress) {
  return read_scene_folder(folder, progress);
}

ExportReport write_rebake(const Scene& scene, const fs::path& folder, const ExportOptions& options,
                          const Progress& progress) {
  if (options.layout)
    throw FieldError("layout", "does not apply to Rebake scenes: every object keeps its own; leave it out");
  ExportReport report;
  AtomicFolder out(folder, options.sources, refuse_foreign_content);
  report.notes = save_scene_folder(scene, out, progress);
  // Pictures do not need the unedited shapes.
  report.preserves_scene = report.notes.size() == unsaved_shapes(scene).size();
  out.commit();
  return report;
}

// One node, which turns the capture's frame.
Scene read_nerf2mesh(const fs::path& folder, const ReadOptions& /*stated by the format*/, const Progress& progress) {
  Node node;
  node.name = folder_title(folder);
  node.object = read_nerf2mesh_folder(folder, progress);
  node.to_parent = nerf2mesh_to_y_up();
  return with_added({}, node, NodeId::none, 0);
}

ExportReport write_nerf2mesh(const Scene& scene, const fs::path& folder, const ExportOptions& options,
                             const Progress& progress) {
  if (options.layout) throw FieldError("layout", "does not apply to nerf2mesh folders; leave it out");
  if (options.page_side) throw FieldError("page_size", "does not apply to nerf2mesh folders; leave it out");
  Scene turned;
  for (const NodePtr& root : scene.roots) {
    Node node = *root;
    node.to_parent = nerf2mesh_to_y_up().inverse(Eigen::Isometry) * node.to_parent;
    turned.roots.push_back(std::make_shared<const Node>(std::move(node)));
  }
  std::vector<std::string> bent, lost_members;
  bool reordered = false;
  const std::vector<Node> nodes =
      merged_for_export(without_bends(turned, &bent), Layout::split, &reordered, &lost_members);
  if (nodes.empty()) throw EditError("there is nothing to export: no visible node has triangles");
  if (nodes.size() > 1)
    throw EditError(
        fmt::format("a nerf2mesh folder holds one network in one orientation, but the scene has {}: export "
                    "single nodes, or save a Rebake scene",
                    nodes.size()));
  ExportReport report;
  if (!bent.empty())
    report.notes.push_back(fmt::format(
        "the format cannot store how bends rotate colours: {} keeps the colours from before the bend; save keeps the "
        "rotations",
        fmt::join(bent, ", ")));
  add_notes_of_merging(reordered, lost_members, report.notes);
  add_notes_of_left_out(scene, true, report.notes);
  AtomicFolder out(folder, options.sources, refuse_foreign_content);
  write_nerf2mesh_folder(out, *nodes.front().object, report.notes, progress);
  out.commit();
  return report;
}

// Whether a path is a file with this extension that is not part of a folder of another format.
template <const char* Extension>
bool is_single_file(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::error_code error;
  return extension == Extension && fs::is_regular_file(path, error) && !fs::exists(path.parent_path() / "mlp.json");
}

// One node, named after the file.
template <std::shared_ptr<const BakedObject> (*Read)(const fs::path&)>
Scene read_single_file(const fs::path& file, const ReadOptions& /*not for meshes*/, const Progress& progress) {
  progress.at("reading " + file.filename().string(), 0);
  Node node;
  node.name = file.stem().string();
  node.object = Read(file);
  return with_added({}, node, NodeId::none, 0);
}

// A scene that Rebake wrote with its features, or one node of the triangles of any other file.
Scene read_glb(const fs::path& file, const ReadOptions& options, const Progress& progress) {
  if (std::optional<Scene> scene = read_gltf_features(file, progress)) return *std::move(scene);
  return read_single_file<read_gltf_object>(file, options, progress);
}

constexpr char obj_extension[] = ".obj", glb_extension[] = ".glb", gltf_extension[] = ".gltf", ply_extension[] = ".ply";

constexpr Format::Folder nerf2mesh_folder{has_nerf2mesh_decoder, own_nerf2mesh_files,
                                          [](const fs::path&) { return std::set<std::string>(); }};
constexpr Format::Folder mobilenerf_folder{has_baked_decoder, own_baked_files,
                                           [](const fs::path&) { return std::set<std::string>(); }};
constexpr Format::Folder rebake_folder{
    has_scene_json, [](const fs::path&) { return std::set<std::string>{"scene.json"}; }, object_folders};

constexpr Format table[] = {
    {"mobilenerf", "MobileNeRF", "for the published viewers", "mlp.json", true, true,
     [](const fs::path& path) {
       return fs::exists(path / "mlp.json") && !fs::exists(path / "scene.json") && !is_nerf2mesh_folder(path);
     },
     read_mobilenerf, baked_files, export_scene, &mobilenerf_folder},
    {"rebake", "Rebake scene", "keeps every node", "scene.json", true, true,
     [](const fs::path& path) { return fs::exists(path / "scene.json"); }, read_rebake, scene_folder_files,
     write_rebake, &rebake_folder},
    {nerf2mesh_format, "nerf2mesh", "only scenes of such folders", "mlp.json", true, true, is_nerf2mesh_folder,
     read_nerf2mesh, nerf2mesh_files, write_nerf2mesh, &nerf2mesh_folder},
    {"obj", "OBJ", "textured meshes", obj_extension, false, true, is_single_file<obj_extension>,
     read_single_file<read_obj_object>, obj_files, nullptr, nullptr, obj_unread_files},
    {"gltf", "glTF", "meshes of mean colours, for modelling programs", glb_extension, false, false,
     is_single_file<glb_extension>, read_glb, gltf_files, write_gltf, nullptr},
    {"gltf_features", "glTF with features", "as gltf, with everything that Rebake needs to read the same scene back",
     glb_extension, false, true, nullptr, nullptr, nullptr, write_gltf_features, nullptr},
    {"gltf_text", "glTF", "textured meshes", gltf_extension, false, true, is_single_file<gltf_extension>,
     read_single_file<read_gltf_object>, gltf_files, nullptr, nullptr},
    {"ply", "PLY", "textured or coloured meshes", ply_extension, false, true, is_single_file<ply_extension>,
     read_single_file<read_ply_object>, ply_files, nullptr, nullptr},
};

}  // namespace

std::string folder_title(const fs::path& path) { return absolute_path(scene_root(path)).filename().string(); }

std::string scene_title(const fs::path& scene) {
  std::error_code error;
  return fs::is_regular_file(scene, error) && scene_root(scene) == scene ? scene.stem().string() : folder_title(scene);
}

std::span<const Format> formats() { return table; }

const Format* format_at(const fs::path& path) {
  for (const Format& format : formats())
    if (format.recognises != nullptr && format.recognises(path)) return &format;
  return nullptr;
}

std::vector<std::string> written_formats() {
  std::vector<std::string> names;
  for (const Format& format : formats())
    if (format.write != nullptr) names.emplace_back(format.name);
  return names;
}

const char* written_formats_help() {
  static const std::string help = [] {
    std::string text;
    for (const Format& format : formats())
      if (format.write != nullptr) text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", format.name, format.help);
    return text;
  }();
  return help.c_str();
}

const char* read_formats_help() {
  static const std::string help = [] {
    std::vector<std::string> folders, files;
    for (const Format& format : formats())
      if (format.read != nullptr)
        (format.is_folder ? folders : files).emplace_back(format.is_folder ? format.title : format.marker);
    return fmt::format("a folder ({}) or a file ({})", fmt::join(folders, ", "), fmt::join(files, ", "));
  }();
  return help.c_str();
}

const Format& format_named(const std::string& name) {
  for (const Format& format : formats())
    if (format.name == name && format.write != nullptr) return format;
  throw FieldError("format", fmt::format("\"{}\" is not known (known: {})", name, fmt::join(written_formats(), ", ")));
}

Scene read_any(const fs::path& named, const ReadOptions& options, const Progress& progress) {
  const fs::path path = scene_root(named);
  if (!fs::exists(path)) throw FileError(path, "does not exist");
  if (const Format* const format = format_at(path)) return format->read(path, options, progress);
  std::vector<std::string> folders, files;
  for (const Format& format : formats())
    if (format.read != nullptr)
      (format.is_folder ? folders : files).push_back(fmt::format("{} ({})", format.marker, format.title));
  if (fs::is_directory(path))
    throw FileError(path, fmt::format("is not a scene: it contains none of {}", fmt::join(folders, ", ")));
  if (fs::exists(path.parent_path() / "mlp.json"))
    throw FileError(path, "is part of a scene's folder; open the folder itself");
  throw FileError(path, files.empty() ? "is not a folder"
                                      : fmt::format("is neither a folder nor one of {}", fmt::join(files, ", ")));
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
