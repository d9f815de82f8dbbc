#pragma once

#include <map>
#include <optional>
#include <vector>

#include "mesh_ops/formats/motion_samples.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Places of a node with keyframes, of its own or of a group above it, in world space.
struct NodePlaces {
  Affine rest;                   ///< as the scene stands
  std::vector<Affine> at_times;  ///< one per sample
};

/// Keyframes of places and of the camera, sampled 30 times per second and on both sides of jumps.
struct SceneMotion {
  std::vector<double> times;            ///< seconds, from 0
  std::map<NodeId, NodePlaces> places;  ///< of the nodes that move
  std::vector<Camera> cameras;          ///< one per sample, with planes; empty without keyframes of the camera

  double duration() const { return times.back(); }
};

/// A scene whose nodes that bend by keyframes have the vertices of their poses.
struct PosedScene {
  Scene scene;
  std::map<NodeId, BendPoses> poses;
};
/// Gives poses to visible nodes with keyframes of bends. Throws as scene_at() does.
PosedScene posed_scene(const Scene& scene);

/// Nothing without keyframes. `poses`: of posed_scene(), for the planes of the camera. Throws EditError for places that
/// cannot be interpolated.
std::optional<SceneMotion> scene_motion(const Scene& scene, const std::map<NodeId, BendPoses>& poses);

}  // namespace rebake
