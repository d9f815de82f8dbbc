#include "editor/edits/scene_change.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "mesh_ops/base/counted.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

namespace {

std::size_t selected_of(const Node& node) { return node.selection ? count(*node.selection) : 0; }

// Number of triangles of which a corner moved or rotated; 0 if the triangles of both objects do not correspond.
std::size_t moved_between(const BakedObject& before, const BakedObject& after) {
  if (before.sets.size() != after.sets.size()) return 0;
  const PackedRotation none{};
  std::size_t moved = 0;
  for (std::size_t s = 0; s < before.sets.size(); ++s) {
    const Soup &old = before.sets[s].soup, &now = after.sets[s].soup;
    if (old.faces().size() != now.faces().size()) return 0;
    if (&old.positions() == &now.positions() && old.rotations() == now.rotations()) continue;
    const auto rotation = [&](const Soup& soup, std::uint32_t v) {
      return soup.rotations() != nullptr ? (*soup.rotations())[v] : none;
    };
    for (std::size_t f = 0; f < old.faces().size(); ++f)
      moved += std::equal(old.faces()[f].begin(), old.faces()[f].end(), now.faces()[f].begin(),
                          [&](std::uint32_t a, std::uint32_t b) {
                            return old.positions()[a] == now.positions()[b] && rotation(old, a) == rotation(now, b);
                          })
                   ? 0
                   : 1;
  }
  return moved;
}

}  // namespace

bool same_selection(const Node& a, const Node& b) {
  return a.selection == b.selection || (a.selection && b.selection && *a.selection == *b.selection);
}

std::string triangles_text(std::size_t triangles) { return counted(triangles, "triangle"); }

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
    if (node && node->object == old.object && same_selection(*node, old)) continue;
    change.names.push_back(old.name);
    change.selected_before += selected_of(old);
    if (old.object) change.triangles_before += old.object->triangle_count();
    if (!node) continue;
    if (old.object && node->object)
      if (const std::size_t moved = moved_between(*old.object, *node->object); moved > 0) {
        change.moved += moved;
        change.with_moved.push_back(node->name);
      }
    change.selected_after += selected_of(*node);
    if (selected_of(*node) > 0) change.with_selected.push_back(node->name);
    if (node->object) change.triangles_after += node->object->triangle_count();
  }
  for (const PlacedNode& placed : placed_nodes(after))
    if (now.contains(placed.node->id) && !now.contains(parent_of(after, placed.node->id)))
      change.added.push_back(placed.node->name);
  return change;
}

}  // namespace rebake
