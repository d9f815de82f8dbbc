#pragma once

#include <optional>
#include <string>

#include "mesh_ops/scene/scene.h"
#include "render/graph/render_view.h"
#include "render/image.h"

namespace rebake {

/// A camera that frames all visible objects, or the 5 %–95 % quantile box of triangle centres if a distant backdrop
/// surrounds it. Forward-facing if all objects are. `aspect`: width / height; `fov_degrees`: vertical. Throws EditError
/// for vertices beyond 1e150.
Camera framing_camera(const Scene& scene, double aspect, double fov_degrees = Camera{}.fov_degrees);

/// The camera; near and far planes that are 0 are fitted to the visible objects.
Camera fitted(const Scene& scene, const Camera& camera, double aspect);

/// View with the given camera, else with the stored view of that name, else with a camera that frames the scene. Throws
/// FieldError if both are given, and for an invalid size, number of samples or camera.
View resolve_view(const Scene& scene, const std::optional<Camera>& camera, const std::string& view_name, int width,
                  int height, int samples);

/// The reason why a picture shows only the background, as a sentence for users; nothing if it shows more.
std::optional<std::string> blank_reason(const Scene& scene, const View& view, const Image& picture);

}  // namespace rebake
