#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace rebake {

/// The object folders that scene.json in a folder names; empty if there is no such file, or another one of its name.
std::set<std::string> object_folders(const std::filesystem::path& folder);

/// Whether scene.json in a folder is one by its content, not only by its name.
bool has_scene_json(const std::filesystem::path& folder);

/// The files that read_scene_folder() reads, relative to the folder. Throws FileError.
std::vector<std::filesystem::path> scene_folder_files(const std::filesystem::path& folder);

}  // namespace rebake
