#include "editor/gui/state/titles.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "editor/edits/scene_change.h"
#include "editor/edits/support.h"

namespace rebake {

namespace {

// The nodes that edits work on: of those that name one as "node", other nodes are places or models.
std::vector<std::string> named(const std::vector<Edit>& group, const Scene& before, const Scene& after) {
  std::vector<std::string> names;
  std::set<NodeId> seen;
  for (const Edit& edit : group) {
    std::vector<NodeId> ids = edit.type().named_nodes(edit.value());
    if (!ids.empty() && to_json(edit).contains("node")) ids.resize(1);
    for (const NodeId id : ids) {
      if (!seen.insert(id).second) continue;
      NodePtr node = find(before, id);
      if (!node) node = find(after, id);
      if (node) names.push_back(node->name);
    }
  }
  return names;
}

// Whether a deforming edit changes a part of its objects: see DeformTarget.
bool is_part(const Edit& edit) {
  const nlohmann::json fields = to_json(edit);
  return !fields.contains("node") || fields.value("selection", false) || fields.contains("box");
}

// Adds the nodes that selecting edits work on and whose selection they leave as it was: it counts with the others.
void add_unchanged(SceneChange& change, const std::vector<Edit>& group, const Scene& before, const Scene& after) {
  std::set<NodeId> inside;  // the named nodes with their children
  bool all = false;
  for (const Edit& edit : group) {
    const std::vector<NodeId> named = edit.type().named_nodes(edit.value());
    inside.insert(named.begin(), named.end());
    all = all || named.empty();
  }
  std::map<NodeId, NodePtr> was;
  for (const PlacedNode& placed : placed_nodes(before)) was[placed.node->id] = placed.node;
  std::vector<std::string> names;
  for (const PlacedNode& placed : placed_nodes(after)) {
    const Node& node = *placed.node;
    if (inside.contains(node.id))
      for (const NodePtr& child : node.children) inside.insert(child->id);
    if (!node.selection || count(*node.selection) == 0) continue;
    const auto old = was.find(node.id);
    const bool same = old != was.end() && same_selection(*old->second, node);
    if (same && ((!all && !inside.contains(node.id)) || !placed.visible || placed.locked)) continue;
    names.push_back(node.name);
    if (!same) continue;
    change.selected_before += count(*node.selection);
    change.selected_after += count(*node.selection);
  }
  change.with_selected = std::move(names);
}

}  // namespace

std::string title_of(const std::vector<Edit>& group, const Scene& before, const Scene& after, const Edit* replaced) {
  if (group.empty()) return "";
  const Edit& first = group.front();
  if (std::string said = first.type().title(first.value()); !said.empty()) {
    if (group.size() > 1) said += fmt::format(" and {} more", group.size() - 1);
    return said;
  }
  SceneChange change = change_between(before, after);
  if (first.type().selects) {
    if (change.names.empty()) return "Selection unchanged";
    add_unchanged(change, group, before, after);
    if (change.selected_after == 0)
      return "Deselected " + triangles_text(change.selected_before) + " in " + listed(change.names);
    const std::string where = " in " + listed(change.with_selected);
    if (change.selected_before == 0) return "Selected " + triangles_text(change.selected_after) + where;
    return fmt::format("Selected {}{} ({}{})", triangles_text(change.selected_after), where,
                       change.selected_after >= change.selected_before ? "+" : "−",
                       change.selected_after >= change.selected_before
                           ? change.selected_after - change.selected_before
                           : change.selected_before - change.selected_after);
  }
  const void* revised = replaced != nullptr && &replaced->type() == &first.type() ? replaced->value() : nullptr;
  if (std::string said = first.type().change_title(first.value(), change, revised); !said.empty()) return said;
  const std::string done = first.type().done(first.value());
  if (first.type().deforms) {
    if (change.moved == 0) return done + " 0 triangles";
    const std::string part = is_part(first) ? triangles_text(change.moved) + " of " : "";
    return done + " " + part + listed(change.with_moved);
  }
  if (first.type().makes_nodes) {
    const std::string of = listed(named(group, before, after));
    return done + " " + of + (change.added.empty() ? "" : " as " + listed(change.added));
  }
  const std::vector<std::string> names = named(group, before, after);
  return done + " " + listed(names.empty() ? change.names : names);
}

std::string title_of(const std::vector<Edit>& group, const Scene& later) {
  if (group.empty()) return "";
  const Edit& first = group.front();
  if (std::string said = first.type().title(first.value()); !said.empty()) return said;
  const std::string of = listed(named(group, later, later));
  if (first.type().selects) return "Selected triangles" + (of.empty() ? "" : " in " + of);
  if (first.type().needs_selection)
    return first.type().done(first.value()) + " the selected triangles" + (of.empty() ? "" : " in " + of);
  if (!of.empty()) return first.type().done(first.value()) + " " + of;
  // Nodes that are named but not there any more were removed later.
  const bool named_some = std::any_of(group.begin(), group.end(),
                                      [](const Edit& edit) { return !edit.type().named_nodes(edit.value()).empty(); });
  return first.type().done(first.value()) + (named_some ? " a node that was removed later" : " the selection");
}

}  // namespace rebake
