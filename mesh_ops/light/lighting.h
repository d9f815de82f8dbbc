#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mesh_ops/base/results.h"
#include "mesh_ops/light/light_decision.h"
#include "mesh_ops/light/turned_light.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// What light does to a scene's colours: a map for each texture set of the nodes where it changes any.
struct Lighting {
  std::map<NodeId, std::vector<std::shared_ptr<const LightMap>>> maps;
  std::map<NodeId, std::shared_ptr<const Light>> lights;  ///< of those, what they were baked in
  std::vector<LightDecision> decisions;
  std::vector<LightDecision> summary;                            ///< of these, for people
  std::map<NodeId, std::shared_ptr<const TurnedLight>> turning;  ///< of LightingOptions::turning
  double left_out = 0;  ///< the sum of what was left out changes: of bounds and of estimates
  /// An estimate left something out: a few places may change more (ChangeEstimate), in pictures most_beyond of the
  /// pixels at most.
  bool estimated = false;
  static constexpr double most_beyond = 0.01;

  /// Of a node's texture set; null where nothing changes, and where its vertices are others by now.
  std::shared_ptr<const LightMap> map_of(NodeId node, std::size_t number, const TextureSet& set) const;
};

struct LightingOptions {
  int rays = 0;        ///< 0: as the scene says
  double spacing = 4;  ///< of light's nodes, in texels; wider where an object would have more than `most_nodes`
  std::size_t most_nodes = 400000;
  bool everything = false;     ///< also what is not called for: to audit
  Results* results = nullptr;  ///< where estimates and traced light are kept; null for nowhere
  bool keep_traced = true;     ///< false: estimates only
  std::set<NodeId> turning{};  ///< nodes whose triangles are about to move: their light is to go along
};

/// The light that a scene calls for (Scene::light; nothing where that is null): decides by bounds, estimates what it
/// needs, traces before and after. Deterministic. Throws EditError where light is traced on a node that is flattened.
Lighting lighting_of(const Scene& scene, const LightingOptions& options = {}, const Progress& progress = {});

/// The light of a scene in which only triangles have moved since `start` was worked out, of nodes in start.turning;
/// nothing is traced. Nothing where more has changed.
std::optional<Lighting> turned_lighting(const Scene& start_scene, const Lighting& start, const Scene& scene);

}  // namespace rebake
