#include "editor/commands/views.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "editor/edits/stored_view.h"
#include "mesh_ops/base/error.h"

namespace rebake {

Camera framing_of(const Scene& scene, double aspect, double fov_degrees) {
  bool forward = true;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.visible && placed.node->object) forward = forward && placed.node->object->axes == Axes::forward;
  return framing(world_bounds(scene), aspect, forward, fov_degrees);
}

Camera fitted(const Scene& scene, const Camera& camera, double aspect) {
  if (camera.near_plane > 0 && camera.far_plane > 0) return camera;
  return with_planes(camera, world_bounds(scene), aspect);
}

View chosen_view(const Scene& scene, const std::optional<Camera>& camera, const std::string& view_name, int width,
                 int height, int samples) {
  if (camera && !view_name.empty()) throw FieldError("view", "contradicts camera");
  View view;
  view.width = width;
  view.height = height;
  view.samples = samples;
  const double aspect = static_cast<double>(width) / std::max(height, 1);
  view.camera = camera               ? fitted(scene, *camera, aspect)
                : !view_name.empty() ? fitted(scene, stored_view(scene, view_name), aspect)
                                     : framing_of(scene, aspect);
  check(view);
  return view;
}

std::optional<std::string> why_blank(const Scene& scene, const View& view, const Image& picture) {
  const auto& bytes = picture.rgb;
  for (std::size_t i = 3; i < bytes.size(); ++i)
    if (bytes[i] != bytes[i - 3]) return std::nullopt;
  const std::string nothing = "the picture shows nothing: ";
  Box box, seen;  // in the camera's space: right, up and depth
  const Mat3 turn = world_to_camera(view.camera);
  bool any_object = false;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object) continue;
    any_object = true;
    if (!placed.visible) continue;
    for (const TextureSet& set : placed.node->object->sets)
      for (const Vec3& p : set.soup.positions()) {
        const Vec3 world = placed.to_world * p;
        if (!world.allFinite()) continue;
        const Vec3 q = turn * (world - view.camera.eye);
        const Vec3 at(q.x(), q.y(), -q.z());
        box.extend(at);
        const double half = half_height(view.camera, at.z()), aspect = static_cast<double>(view.width) / view.height;
        if (std::abs(at.y()) <= half && std::abs(at.x()) <= half * aspect) seen.extend(at);
      }
  }
  if (!any_object) return nothing + "the scene holds no object";
  if (box.isEmpty()) return nothing + "all that could be seen is hidden, deleted, or has no place";
  const double near = view.camera.near_plane, far = view.camera.far_plane;
  if (box.max().z() <= 0) return nothing + "the scene lies behind the camera";
  // Planes are to blame only for what would be in the picture.
  if (seen.isEmpty())
    return nothing + "the scene may lie beside what the camera sees; aim it at its target, or widen it";
  if (seen.min().z() >= far)
    return nothing + fmt::format("the scene begins {:.3g} away, beyond the far plane at {:.3g}", seen.min().z(), far);
  if (seen.max().z() <= near)
    return nothing + fmt::format("the scene ends {:.3g} away, before the near plane at {:.3g}", seen.max().z(), near);
  const double pixel = 2 * half_height(view.camera, seen.min().z()) / view.height;
  if (box.sizes().head<2>().maxCoeff() < pixel) return nothing + "the scene is smaller than a pixel";
  return nothing + "what lies in view is transparent, or has the background's colour";
}

}  // namespace rebake
