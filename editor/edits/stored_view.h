#pragma once

#include <string>
#include <vector>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// The stored view with this name. Throws FieldError for `field`, which lists the stored views, if there is none.
const Camera& stored_view(const Scene& scene, const std::string& name, const char* field = "view");

/// Names of the stored views in natural order: "view 2" before "view 10".
std::vector<std::string> view_names(const Scene& scene);

}  // namespace rebake
