#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mesh_ops/base/source_guard.h"

namespace rebake {

// Files of scenes of any format in the table formats().

/// The path that read_any() reads: the main file of a folder (scene.json, mlp.json) stands for it. It may not exist
/// yet.
std::filesystem::path scene_root(const std::filesystem::path& path);

/// The files of the scene in a folder, relative to it, sorted: those that reading it reads. Other files are skipped.
/// Empty if no format recognises the folder. Throws FileError.
std::vector<std::filesystem::path> scene_files(const std::filesystem::path& folder);

/// Hash of the names and contents of scene_files(). `path`: see scene_root(). Throws FileError.
std::uint64_t folder_hash(const std::filesystem::path& path);

/// Hash of an input's content: of the files of a scene folder, of the cameras of a camera file or folder
/// (camera_hash), of all files of another folder, or of the bytes of another file. Throws FileError.
std::uint64_t content_hash_at(const std::filesystem::path& path);

/// Hash of an output, to notice any change of it: as content_hash_at(), but of the bytes of a file, also if it is a
/// camera file. Throws FileError.
std::uint64_t output_hash_at(const std::filesystem::path& path);

/// Throws FileError if a folder that would be replaced contains anything that is not part of its scene, since it would
/// be lost.
void refuse_foreign_content(const std::filesystem::path& folder);

/// Protects a scene from being overwritten, with files and scenes elsewhere that links in it point to.
void protect_scene(SourceGuard& guard, const std::filesystem::path& path);
/// Protects a scene as protect_scene(), or a single file with those that a mesh refers to. `role`: see
/// SourceGuard::add_file().
void protect_input(SourceGuard& guard, const std::filesystem::path& path,
                   const std::string& role = "a file that this run reads");
/// As protect_scene(), but allows replacing the whole folder: a script may import its own export and run again. See
/// SourceGuard::release_contents().
void protect_scene_contents(SourceGuard& guard, const std::filesystem::path& folder, const std::string& role);

}  // namespace rebake
