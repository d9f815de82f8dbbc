#include "editor/edits/select/grow.h"

#include "editor/edits/describe.h"
#include "mesh_ops/select/morphology.h"

namespace rebake {

Scene apply(const Scene& scene, const Grow& edit) {
  return with_selection_stepped(scene, edit.node, edit.steps, edit.welding, grown);
}

REBAKE_DESCRIBE_EDIT(
    Grow, "Adds the triangles that share a corner with the selection.", (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only of this node and those inside it; left out: of all that is visible and not locked");
      visit("steps", edit.steps, Need::optional, "how often");
      WeldingField::fields(edit.welding, visit);
    })

}  // namespace rebake
