#include "editor/edits/nodes/duplicate.h"

#include "editor/edits/describe_edit.h"
#include "editor/edits/nodes/transform.h"

namespace rebake {

Scene apply(const Scene& scene, const Duplicate& edit) {
  const PlacedNode placed = present(scene, edit.node.id);
  Node copy = without_ids(*placed.node);
  if (!edit.as.empty()) {
    if (find(scene, edit.as) != nullptr)
      throw FieldError("as", "\"" + edit.as + "\" is already the name of another node; choose another name");
    copy.name = edit.as;
  }
  const auto [parent, index] = place_of(scene, edit.node.id);
  const Scene made = with_added(scene, std::move(copy), parent, index + 1);
  if (edit.translate.isZero(0)) return made;
  const auto& beside = parent == NodeId::none ? made.roots : find(made, parent)->children;
  Transform move;
  move.node = NodeRef{beside[index + 1]->id};
  move.translate = edit.translate;
  const Affine before = placed.node->to_parent;
  const Scene moved = apply(made, move);
  if (!placed.node->motion || placed.node->motion->place.empty()) return moved;
  // The copy's keyframes move with it.
  return with_changed(moved, move.node.id, [&](Node& node) {
    const Affine to_parent = node.to_parent;
    node.to_parent = before;
    move_in_parent(node, to_parent * before.inverse());
    node.to_parent = to_parent;
  });
}

REBAKE_DESCRIBE_EDIT(
    Duplicate, "Adds a copy of a node and its children after it; triangles and texels are shared.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::required, "node to copy");
      visit("as", edit.as, Need::optional, "name of the copy; empty: the node's name with a number");
      visit("translate", edit.translate, Need::optional, "offset of the copy from the node", Unit::length);
    })

}  // namespace rebake
