#pragma once

#include <nlohmann/json_fwd.hpp>

#include "mesh_ops/scene/camera.h"

namespace rebake {

/// {"eye", "target", "up", "fov", "near", "far"}. Reading takes what is missing from `base`; throws FieldError.
nlohmann::json camera_json(const Camera& camera);
Camera read_camera_json(const nlohmann::json& value, const Camera& base = {});

}  // namespace rebake
