#include "editor/edits/select/shrink.h"

#include "editor/edits/describe_edit.h"
#include "mesh_ops/select/morphology.h"

namespace rebake {

Scene apply(const Scene& scene, const Shrink& edit) {
  return with_repeated_morphology(scene, edit.node, edit.steps, edit.welding, shrunk);
}

REBAKE_DESCRIBE_EDIT(
    Shrink, "Shrinks the selection by the triangles that share a vertex with unselected ones.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only this node and its children; default: all visible, unlocked objects");
      visit("steps", edit.steps, Need::optional, "number of repetitions");
      WeldingField::fields(edit.welding, visit);
    })

}  // namespace rebake
