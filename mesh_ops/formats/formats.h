#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// A kind of folder that can be opened.
struct Format {
  const char* name;
  bool (*recognises)(const std::filesystem::path& folder);
  Scene (*read)(const std::filesystem::path& folder, Axes axes, const Progress& progress);
};

std::span<const Format> formats();

/// The name that people know a folder by; scene.json stands for its folder.
std::string folder_title(const std::filesystem::path& path);

/// Reads a folder of any known kind as a scene; a MobileNeRF folder becomes one node with the folder's name. `axes` is
/// for folders that do not say. Throws FileError.
Scene read_any(const std::filesystem::path& folder, Axes axes, const Progress& progress = {});

}  // namespace rebake
