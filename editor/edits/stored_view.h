#pragma once

#include <string>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// The stored view of that name. Throws FieldError for `field`, naming those there are.
const Camera& stored_view(const Scene& scene, const std::string& name, const char* field = "view");

}  // namespace rebake
