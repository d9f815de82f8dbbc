#include "editor/edits/nodes/unlock.h"

#include "editor/edits/describe_edit.h"

namespace rebake {

Scene apply(const Scene& scene, const Unlock& edit) {
  present(scene, edit.node.id);
  return with_changed(scene, edit.node.id, [](Node& node) { node.locked = false; });
}

REBAKE_DESCRIBE_EDIT(
    Unlock, "Unlocks a node, so that edits can change it again.",
    (auto& edit, auto& visit) { visit("node", edit.node, Need::required, "node"); })

}  // namespace rebake
