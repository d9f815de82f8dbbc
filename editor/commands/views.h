#pragma once

#include <optional>
#include <string>

#include "mesh_ops/scene/scene.h"
#include "render/graph/view.h"
#include "render/image.h"

namespace rebake {

/// The camera that frames everything visible, or its dense middle where a backdrop lies far around it; forward-facing
/// when all objects are.
Camera framing_of(const Scene& scene, double aspect, double fov_degrees = Camera{}.fov_degrees);

/// The camera with planes that fit what is visible, where it leaves them open.
Camera fitted(const Scene& scene, const Camera& camera, double aspect);

/// What the command line, scripts, the window and Python draw: the camera that is given, else the stored view of a
/// name, else one that frames the scene. Throws FieldError when both are given, and for a size, number of samples or
/// camera that cannot be drawn.
View chosen_view(const Scene& scene, const std::optional<Camera>& camera, const std::string& view_name, int width,
                 int height, int samples);

/// Why a picture shows nothing but the background; nothing where it shows something.
std::optional<std::string> why_blank(const Scene& scene, const View& view, const Image& picture);

}  // namespace rebake
