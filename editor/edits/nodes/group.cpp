#include "editor/edits/nodes/group.h"

#include "editor/edits/describe_edit.h"

namespace rebake {

Scene apply(const Scene& scene, const Group& edit) {
  if (!edit.as.empty() && find(scene, edit.as) != nullptr)
    throw FieldError("as", "\"" + edit.as + "\" is already the name of another node; choose another name");
  Node group;
  // Unlike all nodes that it will contain.
  group.name = edit.as.empty() ? unique_name(scene, "group") : edit.as;
  Scene result = scene;
  for (const NodeRef& ref : edit.nodes) {
    if (!find_placed(result, ref.id))
      throw FieldError("nodes", "must not contain a node twice, or a node inside another one");
    const PlacedNode placed = editable(result, ref.id);
    Node moved = *placed.node;
    if (placed.node->to_parent.matrix() != placed.to_world.matrix()) {
      move_in_parent(moved, placed.to_world * placed.node->to_parent.inverse());
      moved.to_parent = placed.to_world;
    }
    moved.visible = placed.visible;  // a node hidden by a group above stays hidden
    group.children.push_back(std::make_shared<const Node>(std::move(moved)));
    result = without(result, ref.id);
  }
  // The children were removed from `result`, so they can keep their names.
  NodeId id = NodeId::none;
  result = with_added(result, std::move(group), NodeId::none, result.roots.size(), &id);
  check_subtree(result, id);
  return result;
}

REBAKE_DESCRIBE_EDIT(
    Group, "Moves nodes into a new group; their positions in the world stay.", (auto& edit, auto& visit) {
      visit("nodes", edit.nodes, Need::required, "nodes to group");
      visit("as", edit.as, Need::optional, "name of the group; empty: group, or group.2, … if that is taken");
    })

}  // namespace rebake
