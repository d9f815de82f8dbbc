#include "editor/commands/views.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "mesh_ops/base/error.h"

namespace rebake {

Camera framing_of(const Scene& scene, double aspect, double fov_degrees) {
  bool forward = true;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.visible && placed.node->object) forward = forward && placed.node->object->axes == Axes::forward;
  return framing(world_bounds(scene), aspect, forward, fov_degrees);
}

const Camera& stored_view(const Scene& scene, const std::string& name) {
  if (const auto found = scene.views.find(name); found != scene.views.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, camera] : scene.views) names.push_back(known);
  throw FieldError("view", names.empty()
                               ? fmt::format("there is no view \"{}\"; store it with the view edit first", name)
                               : fmt::format("there is no view \"{}\"; there are {}", name, fmt::join(names, ", ")));
}

View chosen_view(const Scene& scene, const std::optional<Camera>& camera, const std::string& view_name, int width,
                 int height, int samples) {
  if (camera && !view_name.empty()) throw FieldError("view", "contradicts camera");
  View view;
  view.width = width;
  view.height = height;
  view.samples = samples;
  view.camera = camera               ? *camera
                : !view_name.empty() ? stored_view(scene, view_name)
                                     : framing_of(scene, static_cast<double>(width) / std::max(height, 1));
  check(view);
  return view;
}

}  // namespace rebake
