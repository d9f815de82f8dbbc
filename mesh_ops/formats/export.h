#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/base/source_guard.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

struct ExportOptions {
  std::optional<Layout> layout;                 ///< nothing: as the objects were read
  SourceGuard sources;                          ///< where nothing may be written
  std::optional<int> page_side = std::nullopt;  ///< texels a side of new textures, 1 to 16384; nothing: as read
};

struct ExportReport {
  bool keeps_everything = false;  ///< what is read back is the scene
  bool one_folder = true;         ///< MobileNeRF: a plain folder; else scene.json with `folders` folders
  std::size_t folders = 1;
  std::vector<std::string> notes;  ///< what the result cannot hold, was converted or dropped
};

/// The objects of a scene merged as far as the format stays exact: positions in world space, rotations folded into
/// decoder weights. Nodes whose folded decoders are equal share an object; triangles turned apart from their object go
/// with those of the same turn. There must be no bent triangle (see without_bends).
/// `reordered`, where given, says whether objects are drawn in another order now.
std::vector<Node> merged_for_export(const Scene& scene, std::optional<Layout> layout, bool* reordered = nullptr);

/// The scene as far as the published format can show it: triangles whose corners are turned differently (bent) get the
/// turn that most of their object has, or their mean where all are bent. Adds the names of objects that have such to
/// `bent`, where given. Turns of whole triangles stay, equal ones made the same bit for bit.
Scene without_bends(const Scene& scene, std::vector<std::string>* bent = nullptr);

/// Writes the scene in the published format: one folder where that is exact, else scene.json with as few folders as
/// stay exact. Replaces the target whole or not at all. Throws FileError, and EditError for an empty scene.
ExportReport export_scene(const Scene& scene, const std::filesystem::path& folder, const ExportOptions& options,
                          const Progress& progress = {});

/// Throws as export_scene does where a folder could not be written, and writes nothing.
void check_can_export(const std::filesystem::path& folder, const SourceGuard& sources);

}  // namespace rebake
