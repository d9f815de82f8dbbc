#include "editor/edits/select/store_selection.h"

#include "editor/edits/describe_edit.h"

namespace rebake {

/// Whether any triangle of the node or of a descendant is selected.
bool any_selected(const Node& node) {
  return node.selection != nullptr || std::any_of(node.children.begin(), node.children.end(),
                                                  [](const NodePtr& child) { return any_selected(*child); });
}

Scene apply(const Scene& scene, const StoreSelection& edit) {
  if (edit.name.empty()) throw FieldError("name", "must not be empty");
  if (std::none_of(scene.roots.begin(), scene.roots.end(), [](const NodePtr& root) { return any_selected(*root); }))
    throw EditError("nothing is selected; select some triangles first");
  Scene result = scene;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object || (!placed.node->selection && !placed.node->saved_selections.contains(edit.name)))
      continue;
    result = with_changed(result, placed.node->id, [&](Node& node) {
      if (node.selection)
        node.saved_selections[edit.name] = node.selection;
      else
        node.saved_selections.erase(edit.name);
    });
  }
  return result;
}

REBAKE_DESCRIBE_EDIT(
    StoreSelection,
    "Stores the present selection of all nodes under a name, for the field saved of select; replaces an earlier one.",
    (auto& edit, auto& visit) { visit("name", edit.name, Need::required, "name of the selection"); })

}  // namespace rebake
