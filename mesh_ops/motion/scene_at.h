#pragma once

#include <functional>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Whether a node of the scene, or its camera, has keyframes.
bool has_keyframes(const Scene& scene);
/// Time of the last keyframe in seconds; 0 without keyframes.
double duration(const Scene& scene);

/// The scene at a time: nodes with keyframes are moved and bent, all others are shared. Keyframes are dropped. Throws
/// Error for transforms that cannot be interpolated, a missing stored selection, and bends that fail; the message names
/// the node.
Scene scene_at(const Scene& scene, double seconds);

/// The triangles of a node that a bend moves, a flag each; regions refer to the unbent object. Throws Error if its
/// stored selection is missing.
TriangleSet bent_triangles(const Node& node, const BendTrack& track);
/// The object of a node bent by all its tracks, by the angles that `degrees` gives. Parts that a later edit took out of
/// the region of a track do not bend.
std::shared_ptr<const BakedObject> bent(const Node& node, const std::function<double(const BendTrack&)>& degrees);

}  // namespace rebake
