#pragma once

#include <nlohmann/json_fwd.hpp>

#include "mesh_ops/scene/keyframes.h"

namespace rebake {

/// Keyframes in scene.json: lists of {"seconds", "value", "to_next"}, where "to_next" is smooth, linear or step.
/// Cameras as camera_json(), transforms as 3 rows of 4 numbers. Readers throw FieldError for times that are not finite
/// or negative, for unknown words and for values that are not finite, and accept any order.
nlohmann::json camera_keys_json(const Keyframes<Camera>& keys);
Keyframes<Camera> read_camera_keys_json(const nlohmann::json& value);

/// {"place": keyframes, "bends": {name: {…, "degrees": keyframes}}}. Bends of stored selections are left out, since
/// scene.json has no selections.
nlohmann::json motion_json(const NodeMotion& motion);
NodeMotion read_motion_json(const nlohmann::json& value);

}  // namespace rebake
