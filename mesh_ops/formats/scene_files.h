#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace rebake {

/// Whether a file name belongs to a MobileNeRF folder or a Rebake scene.
bool is_format_file_name(const std::string& name);

/// The folder of a path to import: a path to scene.json stands for its folder.
std::filesystem::path scene_folder_of(const std::filesystem::path& path);

/// The files of the scene or object in a folder, relative to it, sorted: files of texture sets, and for a scene also
/// scene.json and the files of its object folders. Other files are skipped. Throws FileError.
std::vector<std::filesystem::path> scene_files(const std::filesystem::path& folder);

/// Hash of the names and contents of scene_files(). A path to scene.json stands for its folder. Throws FileError.
std::uint64_t folder_hash(const std::filesystem::path& path);

/// Throws FileError if a folder that would be replaced contains anything that is not part of its scene, since it would
/// be lost.
void refuse_foreign_content(const std::filesystem::path& folder);

}  // namespace rebake
