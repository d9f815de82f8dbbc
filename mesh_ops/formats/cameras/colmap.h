#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mesh_ops/scene/photo_camera.h"

namespace rebake {

// COLMAP's sparse model: cameras and images, as text or binary files (colmap.github.io/format.html). Poses map world to
// camera, whose axes are right, down and forward.

/// The folder with the model: `path` itself, its sparse/0 or its sparse; empty if none has both files.
std::filesystem::path colmap_folder(const std::filesystem::path& path);
/// The two files that read_colmap() reads. Binary files are preferred.
std::vector<std::filesystem::path> colmap_files(const std::filesystem::path& path);

/// Reads the cameras of all images, sorted by name. Throws FileError, also for the models FOV and THIN_PRISM_FISHEYE.
std::vector<PhotoCamera> read_colmap(const std::filesystem::path& path, std::vector<std::string>& notes);

}  // namespace rebake
