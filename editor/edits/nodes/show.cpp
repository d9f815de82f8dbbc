#include "editor/edits/nodes/show.h"

#include "editor/edits/describe_edit.h"

namespace rebake {

Scene apply(const Scene& scene, const Show& edit) {
  present(scene, edit.node.id);
  return with_changed(scene, edit.node.id, [](Node& node) { node.visible = true; });
}

REBAKE_DESCRIBE_EDIT(
    Show, "Shows a hidden node.", (auto& edit, auto& visit) { visit("node", edit.node, Need::required, "node"); })

}  // namespace rebake
