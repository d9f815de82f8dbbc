#pragma once

#include <nlohmann/json_fwd.hpp>

#include "mesh_ops/scene/camera.h"

namespace rebake {

/// {"eye", "target", "up", "fov", "ortho_height", "near", "far"}. Missing members get default values; missing planes
/// are fitted to the scene later (see with_planes). Throws FieldError.
nlohmann::json camera_json(const Camera& camera);
Camera read_camera_json(const nlohmann::json& value);

}  // namespace rebake
