#pragma once

#include <optional>
#include <string>

#include "mesh_ops/scene/scene.h"
#include "render/graph/view.h"
#include "render/image.h"

namespace rebake {

/// A camera that frames all visible objects, or their dense centre if a distant backdrop surrounds it. Forward-facing
/// if all objects are. Throws EditError for vertices beyond 1e150.
Camera framing_of(const Scene& scene, double aspect, double fov_degrees = Camera{}.fov_degrees);

/// The camera; near and far planes that are 0 are fitted to the visible objects.
Camera fitted(const Scene& scene, const Camera& camera, double aspect);

/// View with the given camera, else with the stored view of that name, else with a camera that frames the scene. Throws
/// FieldError if both are given, and for an invalid size, number of samples or camera.
View chosen_view(const Scene& scene, const std::optional<Camera>& camera, const std::string& view_name, int width,
                 int height, int samples);

/// The reason why all pixels of a picture are equal, as a sentence for people; nothing if they are not.
std::optional<std::string> why_blank(const Scene& scene, const View& view, const Image& picture);

}  // namespace rebake
