#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/light/estimate/light_decision.h"
#include "mesh_ops/light/relight/drag_light.h"
#include "mesh_ops/light/relight/lighting_options.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Corrections of a scene's colours by light: a map per texture set of each affected node.
struct Lighting {
  std::map<NodeId, std::vector<std::shared_ptr<const LightMap>>> maps;
  std::map<NodeId, std::shared_ptr<const Light>> lights;  ///< the light each affected node was baked in
  std::vector<LightDecision> decisions;
  std::vector<LightDecision> summary;                          ///< summarised(decisions)
  std::map<NodeId, std::shared_ptr<const DragLight>> turning;  ///< previews during drags (LightingOptions::turning)
  double left_out = 0;  ///< sum of the bounds and estimates of omitted effects, in display colours
  /// Whether an effect was omitted because of an estimate: a few places may change more (ChangeEstimate). In pictures
  /// these are at most a share max_beyond of the pixels.
  bool estimated = false;
  static constexpr double max_beyond = 0.01;

  /// The map of a node's texture set; null if nothing changes or its vertices have changed since.
  std::shared_ptr<const LightMap> map_of(NodeId node, std::size_t number, const TextureSet& set) const;
};

/// Computes the light effects that a scene calls for (none if Scene::light is null): decides by bounds, estimates
/// unknown lights, traces light before and after edits. Deterministic. Throws EditError for a node with a singular
/// transform.
Lighting lighting_of(const Scene& scene, const LightingOptions& options = {}, const Progress& progress = {});

/// Updates `start` for a scene in which only triangles of nodes in start.turning have moved since; nothing is traced.
/// Returns nothing if anything else has changed.
std::optional<Lighting> dragged_lighting(const Scene& start_scene, const Lighting& start, const Scene& scene);

}  // namespace rebake
