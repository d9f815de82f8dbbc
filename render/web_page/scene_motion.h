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

/// Keyframes of places and of the camera, sampled at equal times from 0.
struct SceneMotion {
  double rate = 30;  ///< samples per second
  std::size_t samples = 0;
  std::map<NodeId, NodePlaces> places;  ///< of the nodes that move
  std::vector<Camera> cameras;          ///< one per sample, with planes; empty without keyframes of the camera

  double duration() const { return static_cast<double>(samples - 1) / rate; }
};

/// Nothing without keyframes. Throws EditError for places that cannot be interpolated.
std::optional<SceneMotion> scene_motion(const Scene& scene);

/// A scene whose nodes that bend by keyframes have the vertices of their poses.
struct PosedScene {
  Scene scene;
  std::map<NodeId, BendPoses> poses;
};
/// Gives poses to visible nodes with keyframes of bends. Throws as scene_at() does.
PosedScene posed_scene(const Scene& scene);

}  // namespace rebake
