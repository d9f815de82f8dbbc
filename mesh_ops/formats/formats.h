#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// A folder format that can be read and written; an entry of the table formats().
struct Format {
  const char* name;   ///< identifier in scripts and on the command line
  const char* title;  ///< display name
  bool (*recognises)(const std::filesystem::path& folder);
  Scene (*read)(const std::filesystem::path& folder, Axes axes, const Progress& progress);
  /// Replaces the folder atomically. Throws FileError, and FieldError if the format does not support a given layout.
  ExportReport (*write)(const Scene& scene, const std::filesystem::path& folder, const ExportOptions& options,
                        const Progress& progress);
};

std::span<const Format> formats();
/// Finds a format by its identifier. Throws FieldError that lists the known ones.
const Format& format_named(const std::string& name);

/// Display name of a folder: its last component. scene.json stands for its folder.
std::string folder_title(const std::filesystem::path& path);

/// Reads a folder of any known format as a scene. A MobileNeRF folder becomes one node with the name of the folder.
/// `axes` applies to folders that do not state theirs. Throws FileError.
Scene read_any(const std::filesystem::path& folder, Axes axes, const Progress& progress = {});

/// Assumptions made when the scene's folders were read (Origin::assumptions), as sentences without duplicates.
std::vector<std::string> assumptions_of(const Scene& scene);

}  // namespace rebake
