#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/scene/photo_camera.h"

namespace rebake {

/// Reads nerfstudio's camera_path.json: per frame the 16 numbers of a camera-to-world matrix row by row (columns right,
/// up, back), the vertical field of view in degrees and the aspect. Throws FileError.
std::vector<PhotoCamera> read_nerfstudio_path(const std::filesystem::path& file, std::vector<std::string>& notes);
/// The pictures per second that such a file states; nothing if it states none.
std::optional<double> nerfstudio_path_rate(const std::filesystem::path& file);
/// The text of such a file: 24 frames per second.
std::string nerfstudio_path_text(const std::vector<PhotoCamera>& cameras);

/// Reads a camera path of instant-ngp (base_cam.json): per key frame a quaternion R (x, y, z, w), a position T and the
/// vertical field of view in degrees, in its unit cube, which is undone (scale 0.33, offset 0.5, axes cycled). Throws
/// FileError.
std::vector<PhotoCamera> read_ngp_path(const std::filesystem::path& file, std::vector<std::string>& notes);

}  // namespace rebake
