#include "editor/edits/nodes/lock.h"

#include "editor/edits/describe_edit.h"

namespace rebake {

Scene apply(const Scene& scene, const Lock& edit) {
  present(scene, edit.node.id);
  return with_changed(scene, edit.node.id, [](Node& node) { node.locked = true; });
}

REBAKE_DESCRIBE_EDIT(
    Lock, "Protects a node and its children from edits.",
    (auto& edit, auto& visit) { visit("node", edit.node, Need::required, "node"); })

}  // namespace rebake
