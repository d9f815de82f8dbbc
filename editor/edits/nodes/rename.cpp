#include "editor/edits/nodes/rename.h"

#include "editor/edits/describe_edit.h"

namespace rebake {

Scene apply(const Scene& scene, const Rename& edit) {
  const PlacedNode placed = editable(scene, edit.node.id);
  if (edit.name.empty()) throw FieldError("name", "is empty");
  const NodePtr other = find(scene, edit.name);
  if (other != nullptr && other->id != edit.node.id)
    throw FieldError("name", "\"" + edit.name + "\" is already the name of another node; choose another name");
  return with_changed(scene, edit.node.id, [&](Node& node) { node.name = edit.name; });
}

std::string whole_title(const Rename& edit) { return "Renamed to \"" + edit.name + "\""; }

REBAKE_DESCRIBE_EDIT(
    Rename, "Renames a node.", (auto& edit, auto& visit) {
      visit("node", edit.node, Need::required, "node to rename");
      visit("name", edit.name, Need::required, "new, unique name");
    })

}  // namespace rebake
