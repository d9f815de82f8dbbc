#include "editor/edits/scene_change.h"

#include <fmt/format.h>

#include <map>

#include "mesh_ops/scene/scene.h"

namespace rebake {

namespace {

std::size_t selected_of(const Node& node) { return node.selection ? count(*node.selection) : 0; }

}  // namespace

std::string triangles_text(std::size_t triangles) {
  return triangles == 1 ? "1 triangle" : fmt::format("{} triangles", triangles);
}

std::string listed(const std::vector<std::string>& names) {
  if (names.empty()) return "";
  if (names.size() == 1) return names[0];
  if (names.size() == 2) return names[0] + " and " + names[1];
  return fmt::format("{} objects", names.size());
}

SceneChange change_between(const Scene& before, const Scene& after) {
  SceneChange change;
  std::map<NodeId, NodePtr> now;
  for (const PlacedNode& placed : placed_nodes(after)) now[placed.node->id] = placed.node;
  for (const PlacedNode& placed : placed_nodes(before)) {
    const Node& old = *placed.node;
    const auto found = now.find(old.id);
    const NodePtr node = found == now.end() ? nullptr : found->second;
    if (found != now.end()) now.erase(found);
    if (node && node->object == old.object && node->selection == old.selection) continue;
    change.names.push_back(old.name);
    change.selected_before += selected_of(old);
    if (old.object) change.triangles_before += old.object->triangle_count();
    if (!node) continue;
    change.selected_after += selected_of(*node);
    if (selected_of(*node) > 0) change.with_selected.push_back(node->name);
    if (node->object) change.triangles_after += node->object->triangle_count();
  }
  for (const PlacedNode& placed : placed_nodes(after))
    if (now.contains(placed.node->id)) change.added.push_back(placed.node->name);
  return change;
}

}  // namespace rebake
