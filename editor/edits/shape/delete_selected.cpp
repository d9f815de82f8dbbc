#include "editor/edits/shape/delete_selected.h"

#include <fmt/format.h>

#include "editor/edits/describe_edit.h"
#include "editor/edits/scene_change.h"
#include "mesh_ops/base/counted.h"

namespace rebake {

Outcome apply(const Scene& scene, const DeleteSelected& edit) {
  Scene result = scene;
  std::size_t removed = 0;
  for (const PlacedNode& placed : objects_with_selection(scene, edit.node)) {
    const TriangleSet& selection = *placed.node->selection;
    removed += count(selection);
    const bool all = count(selection) == selection.size();
    // A node without triangles stays if it has children.
    if (all && placed.node->children.empty()) {
      result = without(result, placed.node->id);
      continue;
    }
    result = with_changed(result, placed.node->id, [&](Node& node) { keep_triangles(node, selection, false); });
  }
  std::size_t left = 0;
  for (const PlacedNode& placed : placed_nodes(result))
    if (placed.node->object) left += placed.node->object->triangle_count();
  return {std::move(result), {{fmt::format("{} removed, {} left", counted(removed, "triangle"), left)}}};
}

std::string change_title(const DeleteSelected&, const SceneChange& change, const DeleteSelected*) {
  return "Deleted " + triangles_text(change.triangles_before - change.triangles_after) + " of " + listed(change.names);
}

REBAKE_DESCRIBE_EDIT(
    DeleteSelected, "Deletes the selected triangles, and nodes that lose all their triangles.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional, "only this node; default: all visible, unlocked objects");
    })

}  // namespace rebake
