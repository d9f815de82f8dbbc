#include "editor/edits/select/shrink.h"

#include "editor/edits/describe.h"
#include "mesh_ops/select/morphology.h"

namespace rebake {

Scene apply(const Scene& scene, const Shrink& edit) {
  return with_selection_stepped(scene, edit.node, edit.steps, edit.welding, shrunk);
}

REBAKE_DESCRIBE_EDIT(
    Shrink, "Takes away the selected triangles that share a corner with others.", (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only of this node and those inside it; left out: of all that is visible and not locked");
      visit("steps", edit.steps, Need::optional, "how often");
      WeldingField::fields(edit.welding, visit);
    })

}  // namespace rebake
