#pragma once

#include <string>
#include <vector>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// The stored view of that name. Throws FieldError for `field`, naming those there are.
const Camera& stored_view(const Scene& scene, const std::string& name, const char* field = "view");

/// Names of the stored views as people count: "view 2" before "view 10".
std::vector<std::string> view_names(const Scene& scene);

}  // namespace rebake
