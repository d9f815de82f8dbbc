#include "editor/edits/nodes/duplicate.h"

#include "editor/edits/describe.h"

namespace rebake {

Scene apply(const Scene& scene, const Duplicate& edit) {
  const PlacedNode placed = present(scene, edit.node.id);
  Node copy = without_ids(*placed.node);
  if (!edit.as.empty()) {
    if (find(scene, edit.as) != nullptr)
      throw FieldError("as", "\"" + edit.as + "\" is the name of another node already");
    copy.name = edit.as;
  }
  const auto [parent, index] = place_of(scene, edit.node.id);
  return with_added(scene, std::move(copy), parent, index + 1);
}

REBAKE_DESCRIBE_EDIT(
    Duplicate, "Adds a copy of a node and its children after it; triangles and texels stay shared.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::required, "node to copy");
      visit("as", edit.as, Need::optional, "name of the copy; empty: the node's with a number");
    })

}  // namespace rebake
