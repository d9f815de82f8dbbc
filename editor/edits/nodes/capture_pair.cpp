#include "editor/edits/nodes/capture_pair.h"

#include <set>

namespace rebake {

namespace {

void add_ids(const NodePtr& node, std::set<NodeId>& ids) {
  ids.insert(node->id);
  for (const NodePtr& child : node->children) add_ids(child, ids);
}

}  // namespace

CapturePair capture_pair(const Scene& scene, NodeId node, const std::optional<NodeRef>& to) {
  std::set<NodeId> changed, fixed;
  add_ids(find(scene, node), changed);
  if (to) add_ids(find(scene, to->id), fixed);
  CapturePair pair;
  for (PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object) continue;
    if (!placed.visible) {
      if (changed.contains(placed.node->id)) pair.hidden.push_back(placed.node->id);
      continue;
    }
    const bool changes = changed.contains(placed.node->id), stays = to ? fixed.contains(placed.node->id) : !changes;
    if (changes && stays) throw FieldError("to", "is the node itself, or in it");
    if (changes)
      pair.changed.push_back(std::move(placed));
    else if (stays)
      pair.fixed.push_back(std::move(placed));
  }
  if (pair.changed.empty()) throw FieldError("node", "has no visible object");
  if (pair.fixed.empty()) throw FieldError("to", "has no visible object that could stay");
  return pair;
}

}  // namespace rebake
