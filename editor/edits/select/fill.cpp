#include "editor/edits/select/fill.h"

#include "editor/edits/describe.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/select/morphology.h"

namespace rebake {

Scene apply(const Scene& scene, const Fill& edit) {
  if (edit.at_most < 1) throw FieldError("at_most", "must be at least 1");
  edit.welding.check();
  const std::vector<PlacedNode> targets = selectable(scene, edit.node);
  with_selection(scene, edit.node);
  return with_selected(scene, targets, SelectMode::set, [&](const PlacedNode& placed) {
    return filled(*edges_of(*placed.node->object, edit.welding.tolerance), selection_of(placed),
                  static_cast<std::size_t>(edit.at_most) + 1);
  });
}

REBAKE_DESCRIBE_EDIT(
    Fill, "Adds the islands inside the selection: unselected triangles, joined through edges, that border it.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only of this node and those inside it; left out: of all that is visible and not locked");
      visit("at_most", edit.at_most, Need::optional, "triangles of an island that is filled");
      WeldingField::fields(edit.welding, visit);
    })

}  // namespace rebake
