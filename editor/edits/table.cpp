#include <fmt/format.h>

#include <algorithm>
#include <map>

#include <nlohmann/json.hpp>

#include "editor/edits/describe_edit.h"
#include "mesh_ops/base/error.h"

// Table of all edits, in help order. Each edit has a line here and its own file.
// clang-format off
#define REBAKE_EDITS(X) \
  X(Import) \
  X(Remove) \
  X(Rename) \
  X(Duplicate) \
  X(Group) \
  X(Reorder) \
  X(Show) \
  X(Hide) \
  X(Lock) \
  X(Unlock) \
  X(StoreView) \
  X(ImportViews) \
  X(RenameView) \
  X(RemoveView) \
  X(Key) \
  X(Background) \
  X(GroundEdit) \
  X(LightEdit) \
  X(Transform) \
  X(Place) \
  X(Drop) \
  X(Align) \
  X(Register) \
  X(MatchColors) \
  X(SetLength) \
  X(Select) \
  X(SelectPicture) \
  X(SelectConnected) \
  X(SelectLike) \
  X(SelectFloaters) \
  X(SelectUnneeded) \
  X(SelectMasks) \
  X(SelectTriangles) \
  X(SelectFolded) \
  X(Grow) \
  X(Shrink) \
  X(Fill) \
  X(StoreSelection) \
  X(DeleteSelected) \
  X(DeleteAndFill) \
  X(FillHoles) \
  X(Separate) \
  X(Merge) \
  X(Erase) \
  X(Slim) \
  X(Refit) \
  X(CageDeform) \
  X(HandlesDeform) \
  X(Bend) \
  X(Twist) \
  X(Taper) \
  X(Stretch)
// clang-format on

namespace rebake {

#define REBAKE_DECLARE(Type) \
  struct Type;               \
  template <>                \
  const EditType& edit_type<Type>();
REBAKE_EDITS(REBAKE_DECLARE)
#undef REBAKE_DECLARE

std::span<const EditType* const> edit_types() {
#define REBAKE_ENTRY(Type) &edit_type<Type>(),
  static const EditType* const table[] = {REBAKE_EDITS(REBAKE_ENTRY)};
#undef REBAKE_ENTRY
  return table;
}

Edit read_edit(const nlohmann::json& object, const Scene& scene) {
  if (!object.is_object() || !object.contains("op") || !object.at("op").is_string())
    throw FieldError("op", "must be the name of an edit");
  const auto& op = object.at("op").get_ref<const std::string&>();
  for (const EditType* type : edit_types())
    if (op == type->op) return type->read(object, scene);
  throw FieldError("op", "\"" + op + "\" is not an edit");
}

namespace {

// Report of selecting edits. Counts visible, unlocked nodes: those that edits without a named node change.
std::string selected_line(const char* op, const Scene& scene) {
  std::size_t triangles = 0, selected = 0, others = 0;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    const bool changed = placed.visible && !placed.locked;
    if (placed.node->object && changed) triangles += placed.node->object->triangle_count();
    if (placed.node->selection) (changed ? selected : others) += count(*placed.node->selection);
  }
  const std::string rest = others > 0 ? fmt::format("; {} more in hidden or locked nodes", others) : "";
  return fmt::format("{}: {} of {} triangles selected{}", op, selected, triangles, rest);
}

// Notes that a keyframed bend of the node moves other triangles than before, because its stored selection has changed.
void add_notes_of_bends(const Node& before, const Node& after, std::vector<std::string>& lines) {
  if (!after.motion || after.object != before.object) return;
  for (const auto& [name, bend] : after.motion->bends) {
    const auto was = before.saved_selections.find(bend.selection), now = after.saved_selections.find(bend.selection);
    if (was == before.saved_selections.end()) continue;
    const bool gone = now == after.saved_selections.end();
    if (gone || *now->second != *was->second)
      lines.push_back(fmt::format("note: the keyframed bend \"{}\" of \"{}\" {} the stored selection \"{}\"", name,
                                  after.name, gone ? "needs" : "now moves the triangles of", bend.selection) +
                      (gone ? ", which is gone: films fail until it is stored again" : ""));
  }
}

// The nodes of a scene by id, with their parents.
struct NodeInTree {
  PlacedNode placed;
  NodeId parent = NodeId::none;
};
using Tree = std::map<NodeId, NodeInTree>;
Tree tree_of(const Scene& scene) {
  Tree tree;
  for (PlacedNode& placed : placed_nodes(scene)) tree[placed.node->id].placed = std::move(placed);
  for (auto& [id, one] : tree)
    for (const NodePtr& child : one.placed.node->children) tree.at(child->id).parent = id;
  return tree;
}

// The nodes above a node, the nearest one first.
std::vector<NodePtr> above(const Tree& tree, NodeId node) {
  std::vector<NodePtr> groups;
  for (NodeId up = tree.at(node).parent; up != NodeId::none; up = tree.at(up).parent)
    groups.push_back(tree.at(up).placed.node);
  return groups;
}

// Notes of groups with keyframes that a node has left or entered.
void add_notes_of_groups(const Tree& before, const Tree& after, const NodePtr& node, std::vector<std::string>& lines) {
  const auto compare = [&](const Tree& here, const Tree& there, const char* note) {
    const std::vector<NodePtr> others = above(there, node->id);
    for (const NodePtr& group : above(here, node->id)) {
      const bool moves = group->motion && !group->motion->place.empty();
      const auto same = [&](const NodePtr& other) { return other->id == group->id; };
      if (moves && there.contains(group->id) && std::none_of(others.begin(), others.end(), same))
        lines.push_back(fmt::format(fmt::runtime(note), node->name, group->name));
    }
  };
  compare(before, after, "note: films no longer move \"{}\" by the keyframes of \"{}\", which it has left");
  compare(after, before, "note: films move \"{}\" by the keyframes of \"{}\" from now on, which it has entered");
}

// Notes of what another parent changes although the place in the world stays.
void add_notes_of_parent(const PlacedNode& before, const PlacedNode& after, std::vector<std::string>& lines) {
  if (before.visible && !after.visible)
    lines.push_back(fmt::format("note: \"{}\" is hidden from now on, as the group that it is in", after.node->name));
  if (!after.node->motion || after.node->motion->place.size() < 2) return;
  // From the old parent's axes to those of the new one.
  const Mat3 axes = after.node->to_parent.linear() * before.node->to_parent.linear().inverse();
  if (!axes.isApprox(axes(0, 0) * Mat3::Identity()))
    lines.push_back(fmt::format(
        "note: between its keyframes, \"{}\" may move along another path, because its parent has other axes",
        after.node->name));
}

}  // namespace

Outcome carry_out(const Scene& scene, const Edit& edit, const Progress& progress) {
  Outcome outcome = edit.type().apply(scene, edit.value(), progress);
  std::vector<std::string> lines;
  const Tree before = tree_of(scene), after = tree_of(outcome.scene);
  // Notes that a named node is hidden, because the change is then invisible.
  for (const NodeId id : edit.type().named_nodes(edit.value()))
    if (before.contains(id) && after.contains(id) && !before.at(id).placed.visible && !after.at(id).placed.visible)
      lines.push_back(fmt::format("note: \"{}\" is hidden", after.at(id).placed.node->name));
  // In the order of the outline.
  for (const PlacedNode& placed : placed_nodes(outcome.scene)) {
    const auto found = before.find(placed.node->id);
    if (found == before.end()) continue;
    const Node& was = *found->second.placed.node;
    // Films follow keyframes, not the place that an edit gave.
    if (placed.node->motion && !placed.node->motion->place.empty() && was.motion == placed.node->motion &&
        was.to_parent.matrix() != placed.node->to_parent.matrix())
      lines.push_back(fmt::format("note: films still move \"{}\" by its keyframes; set one (key) to move it there too",
                                  placed.node->name));
    if (found->second.parent != after.at(placed.node->id).parent) {
      add_notes_of_groups(before, after, placed.node, lines);
      add_notes_of_parent(found->second.placed, placed, lines);
    }
    add_notes_of_bends(was, *placed.node, lines);
  }
  if (edit.type().selects) lines.push_back(selected_line(edit.type().op, outcome.scene));
  for (std::string& line : outcome.report.lines) line.insert(0, std::string(edit.type().op) + ": ");
  outcome.report.lines.insert(outcome.report.lines.begin(), lines.begin(), lines.end());
  return outcome;
}

nlohmann::json to_json(const Edit& edit) { return edit.type().write(edit.value()); }

nlohmann::json to_json_with_names(const Edit& edit, const Scene& scene) {
  nlohmann::json line = to_json(edit);
  const auto name = [&](nlohmann::json& value) {
    const NodePtr node = value.is_number_unsigned() ? find(scene, NodeId(value.get<std::uint64_t>())) : nullptr;
    if (node && find(scene, node->name) == node) value = node->name;
  };
  for (const FieldInfo& field : edit.type().fields()) {
    if (!line.contains(field.name)) continue;
    if (field.type.kind == FieldKind::node) name(line.at(field.name));
    if (field.type.kind == FieldKind::nodes)
      for (nlohmann::json& one : line.at(field.name)) name(one);
  }
  return line;
}

}  // namespace rebake
