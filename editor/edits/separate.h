#pragma once

#include "editor/edits/support.h"

namespace rebake {

struct Separate {
  static constexpr const char* op = "separate";
  static constexpr const char* help = "Makes the selected triangles of a node a node of its own, after it.";
  NodeRef node;
  std::string as;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::required, "node to separate from");
    visit("as", self.as, Need::optional, "name of the new node; empty: the node's with a number");
  }
};

inline Scene apply(const Scene& scene, const Separate& edit) {
  const PlacedNode placed = with_selection(scene, edit.node).front();
  if (!edit.as.empty() && find(scene, edit.as) != nullptr)
    throw FieldError("as", "\"" + edit.as + "\" is the name of another node already");
  const TriangleSet& selection = *placed.node->selection;
  const auto rest = triangles_of(*placed.node->object, selection, false);
  if (!rest)
    throw EditError("all triangles of \"" + placed.node->name +
                    "\" are selected; there would be nothing left to separate from");
  Node part;
  part.name = edit.as.empty() ? placed.node->name : edit.as;
  part.visible = placed.node->visible;
  part.to_parent = placed.node->to_parent;
  part.object = triangles_of(*placed.node->object, selection, true);
  const Scene changed = with_changed(scene, placed.node->id, [&](Node& node) {
    node.object = rest;
    node.selection = nullptr;
  });
  const auto [parent, index] = place_of(changed, placed.node->id);
  return with_added(changed, std::move(part), parent, index + 1);
}

}  // namespace rebake
