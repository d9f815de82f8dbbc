#include "editor/actions/views.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "editor/edits/stored_view.h"
#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

// Box between the 5 % and 95 % quantiles of visible triangle centres along each axis, from a sample of about 20000;
// empty for fewer than 20.
Box dense_bounds(const Scene& scene) {
  const std::vector<PlacedNode> placed_all = placed_nodes(scene);
  std::size_t triangles = 0;
  for (const PlacedNode& placed : placed_all)
    if (placed.visible && placed.node->object) triangles += placed.node->object->triangle_count();
  constexpr std::size_t enough = 20000;
  const std::size_t step = std::max<std::size_t>(1, triangles / enough);
  std::array<std::vector<double>, 3> along;
  std::size_t number = 0;
  for (const PlacedNode& placed : placed_all) {
    if (!placed.visible || !placed.node->object) continue;
    for (const TextureSet& set : placed.node->object->sets)
      for (std::size_t f = 0; f < set.soup.triangle_count(); ++f) {
        if (number++ % step != 0) continue;
        Vec3 middle(0, 0, 0);
        for (const std::uint32_t vertex : set.soup.faces()[f]) middle += set.soup.positions()[vertex] / 3;
        middle = placed.to_world * middle;
        if (!middle.allFinite()) continue;
        for (int axis = 0; axis < 3; ++axis) along[static_cast<std::size_t>(axis)].push_back(middle[axis]);
      }
  }
  Box box;
  constexpr std::size_t few = 20;  // too few to leave out a tenth
  if (along[0].size() < few) return box;
  const auto quantile = [&](double share) {
    Vec3 at;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double>& values = along[static_cast<std::size_t>(axis)];
      const auto k = static_cast<std::ptrdiff_t>(std::lround(share * static_cast<double>(values.size() - 1)));
      std::nth_element(values.begin(), values.begin() + k, values.end());
      at[axis] = values[static_cast<std::size_t>(k)];
    }
    return at;
  };
  box.extend(quantile(0.05)).extend(quantile(0.95));
  return box;
}

// Throws EditError for a vertex that is too far away for any camera, before the camera itself is checked.
void check_vertex_distances(const Scene& scene) {
  constexpr double farthest = 1e150;  // its square must be finite
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.visible || !placed.node->object) continue;
    const Box box = transformed(placed.node->object->bounds(), placed.to_world);
    if (box.isEmpty() || (box.min().cwiseAbs().maxCoeff() <= farthest && box.max().cwiseAbs().maxCoeff() <= farthest))
      continue;
    for (std::size_t set = 0; set < placed.node->object->sets.size(); ++set) {
      const std::vector<Vec3>& positions = placed.node->object->sets[set].soup.positions();
      const auto far = std::find_if(positions.begin(), positions.end(), [&](const Vec3& p) {
        const Vec3 world = placed.to_world * p;
        return world.allFinite() && world.cwiseAbs().maxCoeff() > farthest;
      });
      if (far == positions.end()) continue;
      const Vec3 world = placed.to_world * *far;
      throw EditError(fmt::format(
          "node \"{}\": vertex {} of texture set {} at ({:.3g}, {:.3g}, {:.3g}) is too far away to be rendered; delete "
          "it, or hide or move the node",
          placed.node->name, far - positions.begin(), set, world.x(), world.y(), world.z()));
    }
  }
}

}  // namespace

Camera framing_camera(const Scene& scene, double aspect, double fov_degrees) {
  bool forward = true;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.visible && placed.node->object) forward = forward && placed.node->object->axes == Axes::forward;
  check_vertex_distances(scene);
  const Box all = world_bounds(scene);
  if (forward) return framing(all, aspect, forward, fov_degrees);
  // A camera outside of a distant backdrop would show only its back.
  const Box dense = dense_bounds(scene);
  constexpr double backdrop = 0.4;
  const double size = dense.isEmpty() ? 0 : dense.diagonal().norm();
  const bool inside = size > 1e-6 * all.diagonal().norm() && size < backdrop * all.diagonal().norm();
  Camera camera = framing(inside ? dense : all, aspect, forward, fov_degrees);
  if (!inside) return camera;
  camera.near_plane = camera.far_plane = 0;
  return with_planes(camera, all, aspect);
}

Camera fitted(const Scene& scene, const Camera& camera, double aspect) {
  if (camera.near_plane > 0 && camera.far_plane > 0) return camera;
  check_vertex_distances(scene);
  return with_planes(camera, world_bounds(scene), aspect);
}

View resolve_view(const Scene& scene, const std::optional<Camera>& camera, const std::string& view_name, int width,
                  int height, int samples) {
  if (camera && !view_name.empty()) throw FieldError("view", "cannot be combined with camera");
  View view;
  view.width = width;
  view.height = height;
  view.samples = samples;
  const double aspect = static_cast<double>(width) / std::max(height, 1);
  view.camera = camera               ? fitted(scene, *camera, aspect)
                : !view_name.empty() ? fitted(scene, stored_view(scene, view_name), aspect)
                                     : framing_camera(scene, aspect);
  check(view);
  return view;
}

namespace {

bool shows_background_only(const Image& picture, const Color& background) {
  if (!picture.alpha.empty())
    return std::all_of(picture.alpha.begin(), picture.alpha.end(), [](std::uint8_t alpha) { return alpha == 0; });
  constexpr double rounding = 1.0 / 255;
  for (std::size_t i = 0; i < picture.rgb.size(); ++i)
    if (std::abs(picture.rgb[i] / 255.0 - background[static_cast<Eigen::Index>(i % 3)]) > rounding) return false;
  return true;
}

}  // namespace

std::optional<std::string> blank_reason(const Scene& scene, const View& view, const Image& picture) {
  if (!shows_background_only(picture, scene.background)) return std::nullopt;
  const std::string nothing = "the picture is empty: ";
  Box box, seen;  // camera space (right, up, depth): all vertices, and those inside the picture's sides
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
  if (!any_object) return nothing + "the scene contains no object";
  if (box.isEmpty()) return nothing + "all objects are hidden, deleted, or have no finite position";
  const double near = view.camera.near_plane, far = view.camera.far_plane;
  if (box.max().z() <= 0) return nothing + "the scene is behind the camera";
  // Near and far planes are the reason only for vertices inside the picture's sides.
  if (seen.isEmpty())
    return nothing + "the scene may be outside the field of view; aim the camera at it, or widen the field of view";
  const double pixel = 2 * half_height(view.camera, seen.min().z()) / view.height;
  if (box.sizes().head<2>().maxCoeff() < pixel) return nothing + "the scene is smaller than a pixel";
  if (seen.min().z() >= far)
    return nothing +
           fmt::format("the scene begins at depth {:.3g}, beyond the far plane at {:.3g}", seen.min().z(), far);
  if (seen.max().z() <= near)
    return nothing +
           fmt::format("the scene ends at depth {:.3g}, before the near plane at {:.3g}", seen.max().z(), near);
  return nothing + "the visible surfaces are transparent, or have the background's colour";
}

}  // namespace rebake
