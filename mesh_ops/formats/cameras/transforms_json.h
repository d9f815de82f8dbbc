#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mesh_ops/scene/photo_camera.h"

namespace rebake {

// transforms.json of NeRF's synthetic scenes, nerfstudio and instant-ngp: camera-to-world matrices whose columns are
// right, up and back, and intrinsics for all frames or per frame.

/// Reads it. A missing picture size is that of the first photograph that is there, else 800 × 800. Appends
/// assumptions to `notes`. Throws FileError.
std::vector<PhotoCamera> read_transforms(const std::filesystem::path& file, std::vector<std::string>& notes);

/// The text of the file, with full precision.
std::string transforms_text(const std::vector<PhotoCamera>& cameras);

}  // namespace rebake
