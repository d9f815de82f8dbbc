#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// A kind of folder that can be read and written. Each is a line of the one table.
struct Format {
  const char* name;   ///< in scripts and on the command line
  const char* title;  ///< for people
  bool (*recognises)(const std::filesystem::path& folder);
  Scene (*read)(const std::filesystem::path& folder, Axes axes, const Progress& progress);
  /// Replaces the folder whole or not at all. Throws FileError; FieldError for an option that it does not have.
  ExportReport (*write)(const Scene& scene, const std::filesystem::path& folder, const ExportOptions& options,
                        const Progress& progress);
};

std::span<const Format> formats();
/// Throws FieldError that names those there are.
const Format& format_named(const std::string& name);

/// The name that people know a folder by; scene.json stands for its folder.
std::string folder_title(const std::filesystem::path& path);

/// Reads a folder of any known kind as a scene; a MobileNeRF folder becomes one node with the folder's name. `axes` is
/// for folders that do not say. Throws FileError.
Scene read_any(const std::filesystem::path& folder, Axes axes, const Progress& progress = {});

/// What reading a scene's folders assumed (Origin::assumptions), each sentence once.
std::vector<std::string> assumptions_of(const Scene& scene);

}  // namespace rebake
