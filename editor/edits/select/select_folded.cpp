#include "editor/edits/select/select_folded.h"

#include "editor/edits/describe_edit.h"
#include "mesh_ops/deform/deform_object.h"

namespace rebake {

Scene apply(const Scene& scene, const SelectFolded& edit) {
  return with_selected(scene, selectable(scene, edit.node), edit.mode,
                       [](const PlacedNode& placed) { return folded_triangles(*placed.node->object); });
}

REBAKE_DESCRIBE_EDIT(
    SelectFolded,
    "Selects triangles that the last deformation of their object folded or collapsed (det J ≤ 0 at a vertex).",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only this node and its children; default: all visible, unlocked objects");
      visit("mode", edit.mode, Need::optional, "how to combine the result with the present selection");
    })

}  // namespace rebake
