#pragma once

#include "editor/edits/selecting.h"
#include "mesh_ops/deform/deform_object.h"

namespace rebake {

struct SelectFolded {
  static constexpr const char* op = "select_folded";
  static constexpr const char* help =
      "Selects triangles that the last deformation of their object folded or collapsed (det J ≤ 0 at a corner).";
  std::optional<NodeRef> node;
  SelectMode mode = SelectMode::set;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::optional, "only of this node and those inside it; left out: of all that is visible");
    visit("mode", self.mode, Need::optional, "how the result joins the present selection");
  }
};

inline Scene apply(const Scene& scene, const SelectFolded& edit) {
  return with_selected(scene, selectable(scene, edit.node), edit.mode, [](const PlacedNode& placed) {
    const BakedObject& object = *placed.node->object;
    return object.deformation ? object.deformation->folded_triangles : TriangleSet(object.triangle_count(), 0);
  });
}

}  // namespace rebake
