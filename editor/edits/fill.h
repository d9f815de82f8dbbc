#pragma once

#include "editor/edits/selecting.h"
#include "mesh_ops/select/index.h"

namespace rebake {

struct Fill {
  static constexpr const char* op = "fill";
  static constexpr const char* help =
      "Adds the islands inside the selection: unselected triangles, joined through edges, that border it.";
  std::optional<NodeRef> node;
  int at_most = 1000;
  WeldingField welding;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::optional, "only of this node and those inside it; left out: of all that is visible");
    visit("at_most", self.at_most, Need::optional, "triangles of an island that is filled");
    WeldingField::fields(self.welding, visit);
  }
};

inline Scene apply(const Scene& scene, const Fill& edit) {
  if (edit.at_most < 1) throw FieldError("at_most", "must be at least 1");
  edit.welding.check();
  with_selection(scene, edit.node);
  return with_selected(scene, selectable(scene, edit.node), SelectMode::set, [&](const PlacedNode& placed) {
    return filled(*edges_of(*placed.node->object, edit.welding.tolerance), selection_of(placed),
                  static_cast<std::size_t>(edit.at_most) + 1);
  });
}

}  // namespace rebake
