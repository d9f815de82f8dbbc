#include "editor/edits/select/grow.h"

#include "editor/edits/describe_edit.h"
#include "mesh_ops/select/morphology.h"

namespace rebake {

Scene apply(const Scene& scene, const Grow& edit) {
  return with_repeated_morphology(scene, edit.node, edit.steps, edit.welding, grown);
}

REBAKE_DESCRIBE_EDIT(
    Grow, "Grows the selection by the triangles that share a vertex with it.", (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only this node and its children; default: all visible, unlocked objects");
      visit("steps", edit.steps, Need::optional, "number of repetitions");
      WeldingField::fields(edit.welding, visit);
    })

}  // namespace rebake
