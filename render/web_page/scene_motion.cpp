#include "render/web_page/scene_motion.h"

#include <algorithm>
#include <cmath>

#include "mesh_ops/formats/gltf_features.h"
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

namespace {

// Before a jump, values are sampled this much earlier.
constexpr double jump = 1e-4;  // seconds

template <class Value>
void add_jumps(const Keyframes<Value>& keys, std::vector<double>& times) {
  for (std::size_t k = 1; k < keys.size(); ++k)
    if (keys[k - 1].to_next == Interpolation::step)
      times.insert(times.end(), {std::max(keys[k - 1].seconds, keys[k].seconds - jump), keys[k].seconds});
}

std::vector<double> sample_times(const Scene& scene, double duration) {
  // Long motions get fewer samples per second.
  constexpr double usual_rate = 30, most_samples = 20000;
  const double rate = std::min(usual_rate, most_samples / std::max(1.0, duration));
  std::vector<double> times;
  for (std::size_t k = 0; static_cast<double>(k) < duration * rate; ++k) times.push_back(static_cast<double>(k) / rate);
  times.push_back(duration);
  add_jumps(scene.camera_keys, times);
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.node->motion) add_jumps(placed.node->motion->place, times);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

}  // namespace

std::optional<SceneMotion> scene_motion(const Scene& given, const std::map<NodeId, BendPoses>& poses) {
  // Hidden nodes are not part of a page.
  const Scene whole = visible_part(given);
  if (!has_keyframes(whole)) return std::nullopt;
  // Bends are poses, see posed_scene().
  const Scene scene = without_bend_keys(whole);
  SceneMotion motion;
  motion.times = sample_times(scene, duration(whole));
  std::map<NodeId, NodePlaces> places;
  for (const PlacedNode& placed : placed_nodes(scene)) places[placed.node->id].rest = placed.to_world;
  for (const double seconds : motion.times) {
    const Scene moved = scene_at(scene, seconds);
    Box bounds = world_bounds(moved);
    for (const PlacedNode& placed : placed_nodes(moved)) {
      places[placed.node->id].at_times.push_back(placed.to_world);
      if (const auto bends = poses.find(placed.node->id); bends != poses.end())
        for (const auto& pose : bends->second.poses) bounds.extend(transformed(pose->bounds(), placed.to_world));
    }
    if (!scene.camera_keys.empty())
      motion.cameras.push_back(with_planes(value_at(scene.camera_keys, seconds), bounds, 1));
  }
  for (auto& [node, one] : places)
    if (std::any_of(one.at_times.begin(), one.at_times.end(),
                    [&](const Affine& at) { return at.matrix() != one.rest.matrix(); }))
      motion.places.emplace(node, std::move(one));
  return motion;
}

}  // namespace rebake
