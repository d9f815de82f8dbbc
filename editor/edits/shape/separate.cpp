#include "editor/edits/shape/separate.h"

#include <fmt/format.h>

#include "editor/edits/describe_edit.h"
#include "editor/edits/scene_change.h"

namespace rebake {

namespace {

// Notes of keyframed bends with a soft border, which ends where the parts are cut.
std::vector<std::string> notes_of_borders(const Node& node) {
  std::vector<std::string> notes;
  if (!node.motion) return notes;
  for (const auto& [name, bend] : node.motion->bends)
    if (bend.falloff > 0 && (bend.box || !bend.selection.empty()))
      notes.push_back(
          fmt::format("note: films bend both parts by \"{}\"; its soft border ends where they were cut", name));
  return notes;
}

}  // namespace

Outcome apply(const Scene& scene, const Separate& edit) {
  const PlacedNode placed = object_with_selection(scene, edit.node);
  if (!edit.as.empty() && find(scene, edit.as) != nullptr)
    throw FieldError("as", "\"" + edit.as + "\" is already the name of another node; choose another name");
  const TriangleSet& selection = *placed.node->selection;
  if (count(selection) == selection.size())
    throw EditError("all triangles of \"" + placed.node->name +
                    "\" are selected; deselect some, or rename the node instead");
  Node part = *placed.node;
  part.id = NodeId::none;
  part.name = edit.as.empty() ? placed.node->name : edit.as;
  part.children.clear();
  keep_triangles(part, selection, true);
  const Scene changed =
      with_changed(scene, placed.node->id, [&](Node& node) { keep_triangles(node, selection, false); });
  const auto [parent, index] = place_of(changed, placed.node->id);
  return {with_added(changed, std::move(part), parent, index + 1), {notes_of_borders(*placed.node)}};
}

std::string change_title(const Separate&, const SceneChange& change, const Separate*) {
  return "Separated " + triangles_text(change.selected_before) + " as " + listed(change.added);
}

REBAKE_DESCRIBE_EDIT(
    Separate, "Moves the selected triangles of a node into a new node after it.", (auto& edit, auto& visit) {
      visit("node", edit.node, Need::required, "node to separate from");
      visit("as", edit.as, Need::optional, "name of the new node; empty: the node's name with a number");
    })

}  // namespace rebake
