#include "editor/edits/select/fill.h"

#include "editor/edits/describe_edit.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/select/morphology.h"

namespace rebake {

Scene apply(const Scene& scene, const Fill& edit) {
  if (edit.at_most < 1) throw FieldError("at_most", "must be at least 1");
  edit.welding.check();
  const std::vector<PlacedNode> targets = selectable(scene, edit.node);
  objects_with_selection(scene, edit.node);
  return with_selected(scene, targets, SelectMode::set, [&](const PlacedNode& placed) {
    return filled(*edges_of(*placed.node->object, edit.welding.tolerance), selection_of(placed),
                  static_cast<std::size_t>(edit.at_most) + 1);
  });
}

REBAKE_DESCRIBE_EDIT(
    Fill, "Fills holes of the selection: adds edge-connected components of unselected triangles that border it.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only this node and its children; default: all visible, unlocked objects");
      visit("at_most", edit.at_most, Need::optional, "largest component to add, in triangles");
      WeldingField::fields(edit.welding, visit);
    })

}  // namespace rebake
