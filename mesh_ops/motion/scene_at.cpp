#include "mesh_ops/motion/scene_at.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh_ops/base/error.h"
#include "mesh_ops/deform/deform_object.h"
#include "mesh_ops/deform/form_deformation.h"
#include "mesh_ops/select/regions.h"

namespace rebake {

namespace {

// The node at a time, with the nodes below it; the node itself if nothing in it moves.
NodePtr node_at(const NodePtr& node, double seconds) {
  std::vector<NodePtr> children;
  bool changes = node->motion != nullptr;
  for (const NodePtr& child : node->children) {
    children.push_back(node_at(child, seconds));
    changes = changes || children.back() != child;
  }
  if (!changes) return node;
  Node result = *node;
  result.children = std::move(children);
  result.motion = nullptr;
  if (!node->motion) return std::make_shared<const Node>(std::move(result));
  try {
    if (!node->motion->place.empty()) result.to_parent = value_at(node->motion->place, seconds);
    if (node->object)
      result.object = bent(*node, [&](const BendTrack& track) { return value_at(track.degrees, seconds); });
  } catch (const Error& error) {
    throw EditError(fmt::format("\"{}\" at {:.6g} s: {}", node->name, seconds, error.what()));
  }
  return std::make_shared<const Node>(std::move(result));
}

}  // namespace

bool has_keyframes(const Scene& scene) {
  const std::vector<PlacedNode> nodes = placed_nodes(scene);
  return !scene.camera_keys.empty() || std::any_of(nodes.begin(), nodes.end(), [](const PlacedNode& placed) {
    return placed.node->motion != nullptr;
  });
}

double duration(const Scene& scene) {
  double last = scene.camera_keys.empty() ? 0 : scene.camera_keys.back().seconds;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->motion) continue;
    if (const auto& keys = placed.node->motion->place; !keys.empty()) last = std::max(last, keys.back().seconds);
    for (const auto& [name, track] : placed.node->motion->bends) last = std::max(last, track.degrees.back().seconds);
  }
  return last;
}

Scene scene_at(const Scene& scene, double seconds) {
  if (!std::isfinite(seconds)) throw FieldError("time", "must be finite");
  Scene result = scene;
  for (NodePtr& root : result.roots) root = node_at(root, seconds);
  result.camera_keys.clear();
  return result;
}

TriangleSet bent_triangles(const Node& node, const BendTrack& track) {
  if (!node.object) throw Error("the node has no triangles to bend");
  TriangleSet flags(node.object->triangle_count(), std::uint8_t{1});
  if (!track.selection.empty()) {
    const auto stored = node.saved_selections.find(track.selection);
    if (stored == node.saved_selections.end())
      throw Error(
          fmt::format("its bend needs the stored selection \"{}\", which the node no longer has", track.selection));
    flags = *stored->second;
  }
  if (track.box) {
    const TriangleSet inside = triangles_by_centre(
        *node.object, [&](const Vec3& centre) { return track.box->contains(Vec3(track.to_box * centre)); });
    for (std::size_t f = 0; f < flags.size(); ++f) flags[f] &= inside[f];
  }
  return flags;
}

namespace {

std::shared_ptr<const BakedObject> bent_by(const std::shared_ptr<const BakedObject>& object, const TriangleSet& flags,
                                           const BendTrack& track, double degrees) {
  ClosedForm form;
  form.kind = ClosedForm::Kind::bend;
  form.origin = track.origin;
  form.axis = track.axis;
  form.direction = track.direction;
  form.from = track.from;
  form.to = track.to;
  form.radians = degrees * std::numbers::pi / 180;
  check(form);
  return deformed(*object, track.to_space, flags, track.falloff,
                  track.spine.empty() ? deformation_by(form) : deformation_by(along_curve(form, track.spine)))
      .object;
}

}  // namespace

std::shared_ptr<const BakedObject> bent(const Node& node, const std::function<double(const BendTrack&)>& degrees) {
  std::shared_ptr<const BakedObject> object = node.object;
  for (const auto& [name, track] : node.motion->bends) {
    const double angle = degrees(track);
    if (angle == 0) continue;
    // Bends keep the number and order of triangles.
    if (const TriangleSet flags = bent_triangles(node, track); count(flags) > 0)
      object = bent_by(object, flags, track, angle);
  }
  return object;
}

}  // namespace rebake
