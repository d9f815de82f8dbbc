#include "editor/edits/nodes/reorder.h"

#include "editor/edits/describe_edit.h"

namespace rebake {

Scene apply(const Scene& scene, const Reorder& edit) {
  const PlacedNode placed = editable(scene, edit.node.id);
  if (edit.index < 0) throw FieldError("index", "must be 0 or more");
  if (edit.top && edit.parent) throw FieldError("top", "cannot be combined with parent");
  const NodeId parent = edit.top ? NodeId::none : edit.parent ? edit.parent->id : parent_of(scene, edit.node.id);
  const Scene rest = without(scene, edit.node.id);
  Node moved = *placed.node;
  Affine parent_to_world = Affine::Identity();
  if (parent != NodeId::none) {
    const auto target = find_placed(rest, parent);
    if (!target) throw FieldError("parent", "is the node itself or one of its descendants");
    if (target->node->object) throw FieldError("parent", "\"" + target->node->name + "\" is an object, not a group");
    editable(scene, parent);
    parent_to_world = target->to_world;
  }
  if (parent != parent_of(scene, edit.node.id)) {
    const Affine to_parent = parent_to_world.inverse() * placed.to_world;
    move_in_parent(moved, to_parent * placed.node->to_parent.inverse());
    moved.to_parent = to_parent;
    moved.visible = placed.visible;  // a node hidden by a group above stays hidden
  }
  const Scene result = with_added(rest, std::move(moved), parent, static_cast<std::size_t>(edit.index));
  check_subtree(result, edit.node.id);
  return result;
}

REBAKE_DESCRIBE_EDIT(
    Reorder, "Moves a node to another position or group in the outline; its position in the world stays.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::required, "node to move");
      visit("index", edit.index, Need::required,
            "position among the siblings, from 0; at equal depth, later nodes are drawn on top");
      visit("parent", edit.parent, Need::optional, "group to move into; default: the present one");
      visit("top", edit.top, Need::optional, "move to the top level, out of all groups");
    })

}  // namespace rebake
