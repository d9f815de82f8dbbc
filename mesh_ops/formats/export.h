#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/base/source_guard.h"
#include "mesh_ops/formats/gltf_compression.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Options of writing a scene.
struct ExportOptions {
  std::optional<Layout> layout;  ///< layout of the files; empty: as the objects were read
  SourceGuard sources;           ///< files and folders that must not be overwritten
  /// Largest side of new textures in texels, 1 … 16384; empty: largest_page_side(). Rebake scenes ignore it.
  std::optional<int> page_side = std::nullopt;
  /// For formats without view dependence: colours as seen from this point in world space; empty: means over directions.
  std::optional<Vec3> colors_from = std::nullopt;
  GltfCompression compression{};  ///< of glTF files
};

/// Result of writing a scene.
struct ExportReport {
  bool preserves_scene = false;  ///< whether reading the result gives the same scene
  bool one_folder = true;        ///< MobileNeRF format: whether it is one plain folder, without scene.json
  std::size_t folders = 1;
  std::vector<std::string> notes;  ///< sentences for the user: data that was dropped, converted or cannot be stored
};

/// Merges the visible objects of a scene as far as the format stays exact: positions in world space, rotations folded
/// into decoder weights. Nodes whose folded decoders are equal share an object. Triangles that edits rotated relative
/// to their object are grouped by rotation. No triangle may be bent (see without_bends). `layout`: for all objects;
/// empty: each keeps its own, and only objects of the same layout merge. If not null, sets `reordered` to whether
/// objects are drawn in another order than before, and appends to `lost_members` the unknown members of mlp.json
/// (BakedObject::other_members) of which another object has another value.
std::vector<Node> merged_for_export(const Scene& scene, std::optional<Layout> layout, bool* reordered = nullptr,
                                    std::vector<std::string>* lost_members = nullptr);

/// Appends sentences about what merged_for_export() changed.
void add_notes_of_merging(bool reordered, const std::vector<std::string>& lost_members,
                          std::vector<std::string>& notes);
/// Appends sentences about what exports leave out of nodes: hidden ones, locks and stored selections.
void add_notes_of_nodes(const Scene& scene, std::vector<std::string>& notes);
/// As add_notes_of_nodes(), and about keyframes, and in `one_folder` background, views, ground and light settings.
void add_notes_of_left_out(const Scene& scene, bool one_folder, std::vector<std::string>& notes);

/// Makes a scene that the published format can represent. Bent triangles, whose corners have different rotations, get
/// the most common rotation of their object, or the mean if all are bent. Whole triangles keep their rotations; nearly
/// equal ones become equal bit for bit. Appends the names of nodes with bent triangles to `bent`, if not null.
Scene without_bends(const Scene& scene, std::vector<std::string>* bent = nullptr);

/// Writes the scene in the published format: one folder if that is exact, otherwise scene.json with as few folders as
/// stay exact. Replaces the target folder atomically. Throws FileError, and EditError for a scene without visible
/// triangles.
ExportReport export_scene(const Scene& scene, const std::filesystem::path& folder, const ExportOptions& options,
                          const Progress& progress = {});

/// Throws the FileError that export_scene() would throw for an unsuitable target folder; writes nothing.
void check_can_export(const std::filesystem::path& folder, const SourceGuard& sources);

}  // namespace rebake
