#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace rebake {

/// True for file names that belong to a MobileNeRF folder or a Rebake scene.
bool is_format_file_name(const std::string& name);

/// The folder of what an import names: scene.json stands for its folder.
std::filesystem::path scene_folder_of(const std::filesystem::path& path);

/// The files that belong to what lies in a folder, relative to it, in order: those of its texture sets, and for a scene
/// scene.json and the files of the folders that it names. What lies beside them is left out. Throws FileError.
std::vector<std::filesystem::path> scene_files(const std::filesystem::path& folder);

/// Names and bytes of those files in one number; scene.json stands for its folder. Throws FileError.
std::uint64_t folder_hash(const std::filesystem::path& path);

/// Throws FileError when a folder that is to be replaced holds what is not part of the scene in it: it would be lost.
void refuse_foreign_content(const std::filesystem::path& folder);

}  // namespace rebake
