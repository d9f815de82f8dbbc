#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mesh_ops/scene/photo_camera.h"

namespace rebake {

/// Reads poses_bounds.npy of forward-facing captures (LLFF): per photograph a 3 × 5 matrix with the columns down,
/// right, back, eye, and (height, width, focal length), then the nearest and the farthest depth. Photographs are those
/// of the folder `images` beside it, in order of their names, if there are as many. Appends notes. Throws FileError.
std::vector<PhotoCamera> read_poses_bounds(const std::filesystem::path& file, std::vector<std::string>& notes);

}  // namespace rebake
