#include "editor/edits/nodes/hide.h"

#include "editor/edits/describe_edit.h"

namespace rebake {

Scene apply(const Scene& scene, const Hide& edit) {
  present(scene, edit.node.id);
  return with_changed(scene, edit.node.id, [](Node& node) { node.visible = false; });
}

REBAKE_DESCRIBE_EDIT(
    Hide, "Hides a node and its children: they are neither drawn nor exported, but saved.",
    (auto& edit, auto& visit) { visit("node", edit.node, Need::required, "node"); })

}  // namespace rebake
