#include "editor/edits/nodes/remove.h"

#include "editor/edits/describe_edit.h"

namespace rebake {

Scene apply(const Scene& scene, const Remove& edit) {
  editable_with_children(scene, edit.node.id);
  return without(scene, edit.node.id);
}

REBAKE_DESCRIBE_EDIT(
    Remove, "Removes a node and its children from the scene.",
    (auto& edit, auto& visit) { visit("node", edit.node, Need::required, "node to remove"); })

}  // namespace rebake
