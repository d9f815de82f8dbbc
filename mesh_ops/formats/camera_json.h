#pragma once

#include <nlohmann/json_fwd.hpp>

#include "mesh_ops/scene/camera.h"

namespace rebake {

/// {"eye", "target", "up", "fov", "ortho_height", "near", "far"}. What is left out has its usual value; planes are left
/// open (see with_planes). Throws FieldError.
nlohmann::json camera_json(const Camera& camera);
Camera read_camera_json(const nlohmann::json& value);

}  // namespace rebake
