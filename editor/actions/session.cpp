#include "editor/actions/session.h"

#include "render/picture.h"

namespace rebake {

Session::Session() = default;
Session::~Session() = default;

Renderer& Session::renderer() {
  if (!renderer_) renderer_ = std::make_unique<Renderer>();
  return *renderer_;
}

Camera framing_of(const Scene& scene, double aspect, double fov_degrees) {
  bool forward = true;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.visible && placed.node->object) forward = forward && placed.node->object->axes == Axes::forward;
  return framing(world_bounds(scene), aspect, forward, fov_degrees);
}

}  // namespace rebake
