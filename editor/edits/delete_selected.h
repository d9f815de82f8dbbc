#pragma once

#include "editor/edits/support.h"

namespace rebake {

struct DeleteSelected {
  static constexpr const char* op = "delete";
  static constexpr const char* help = "Removes the selected triangles; a node that loses all goes too.";
  std::optional<NodeRef> node;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::optional, "only of this node; left out: of all that are visible and not locked");
  }
};

inline Scene apply(const Scene& scene, const DeleteSelected& edit) {
  Scene result = scene;
  for (const PlacedNode& placed : with_selection(scene, edit.node)) {
    const TriangleSet& selection = *placed.node->selection;
    const bool all = count(selection) == selection.size();
    // A node without triangles stays when it groups others.
    if (all && placed.node->children.empty()) {
      result = without(result, placed.node->id);
      continue;
    }
    result = with_changed(result, placed.node->id, [&](Node& node) { keep_triangles(node, selection, false); });
  }
  return result;
}

}  // namespace rebake
