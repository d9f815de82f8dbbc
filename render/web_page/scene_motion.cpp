#include "render/web_page/scene_motion.h"

#include <algorithm>
#include <cmath>

#include "mesh_ops/motion/scene_at.h"

namespace rebake {

namespace {

// The scene without keyframes of bends.
Scene without_bend_keys(const Scene& scene) {
  Scene result = scene;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->motion || placed.node->motion->bends.empty()) continue;
    NodeMotion motion = *placed.node->motion;
    motion.bends.clear();
    result = with_changed(result, placed.node->id, [&](Node& node) {
      node.motion = motion.empty() ? nullptr : std::make_shared<const NodeMotion>(motion);
    });
  }
  return result;
}

}  // namespace

PosedScene posed_scene(const Scene& scene) {
  PosedScene posed{scene, {}};
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.visible || !placed.node->object || !placed.node->motion || placed.node->motion->bends.empty()) continue;
    BendPoses poses = bend_poses(*placed.node);
    posed.scene = with_changed(posed.scene, placed.node->id, [&](Node& node) { node.object = poses.rest; });
    posed.poses.emplace(placed.node->id, std::move(poses));
  }
  return posed;
}

std::optional<SceneMotion> scene_motion(const Scene& whole) {
  if (!has_keyframes(whole)) return std::nullopt;
  // Bends are poses, see posed_scene().
  const Scene scene = without_bend_keys(whole);
  SceneMotion motion;
  // Long motions get fewer samples per second.
  constexpr double most_samples = 20000;
  motion.rate = std::min(motion.rate, most_samples / std::max(1.0, duration(whole)));
  motion.samples = static_cast<std::size_t>(std::ceil(duration(whole) * motion.rate)) + 1;
  std::map<NodeId, NodePlaces> places;
  for (const PlacedNode& placed : placed_nodes(scene)) places[placed.node->id].rest = placed.to_world;
  for (std::size_t t = 0; t < motion.samples; ++t) {
    const double seconds = static_cast<double>(t) / motion.rate;
    const Scene moved = scene_at(scene, seconds);
    for (const PlacedNode& placed : placed_nodes(moved)) places[placed.node->id].at_times.push_back(placed.to_world);
    if (!scene.camera_keys.empty())
      motion.cameras.push_back(with_planes(value_at(scene.camera_keys, seconds), world_bounds(moved), 1));
  }
  for (auto& [node, one] : places)
    if (std::any_of(one.at_times.begin(), one.at_times.end(),
                    [&](const Affine& at) { return at.matrix() != one.rest.matrix(); }))
      motion.places.emplace(node, std::move(one));
  return motion;
}

}  // namespace rebake
