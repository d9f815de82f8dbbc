#include "editor/gui/state/titles.h"

#include <fmt/format.h>

#include <map>
#include <set>

#include "editor/edits/deform/cage.h"
#include "editor/edits/nodes/transform.h"
#include "editor/edits/shape/delete_selected.h"
#include "editor/edits/shape/erase.h"
#include "editor/edits/shape/separate.h"
#include "editor/edits/shape/slim.h"
#include "editor/edits/support.h"

namespace rebake {

namespace {

std::size_t selected_of(const Node& node) { return node.selection ? count(*node.selection) : 0; }

std::string amount(std::size_t triangles) {
  return triangles == 1 ? "1 triangle" : fmt::format("{} triangles", triangles);
}

// "ficus", "ficus and kettle", "3 objects".
std::string together(const std::vector<std::string>& names) {
  if (names.empty()) return "";
  if (names.size() == 1) return names[0];
  if (names.size() == 2) return names[0] + " and " + names[1];
  return fmt::format("{} objects", names.size());
}

// Difference of two scenes. Counts are sums over the nodes that changed.
struct Change {
  std::vector<std::string> names;  ///< names of nodes whose triangles or selection changed, and of removed nodes
  std::vector<std::string> with_selected;  ///< names of changed nodes with selected triangles afterwards
  std::size_t selected_before = 0, selected_after = 0;
  std::size_t triangles_before = 0, triangles_after = 0;
  std::vector<std::string> added;  ///< names of new nodes
};
Change change_between(const Scene& before, const Scene& after) {
  Change change;
  std::map<NodeId, NodePtr> now;
  for (const PlacedNode& placed : placed_nodes(after)) now[placed.node->id] = placed.node;
  for (const PlacedNode& placed : placed_nodes(before)) {
    const Node& old = *placed.node;
    const auto found = now.find(old.id);
    const NodePtr node = found == now.end() ? nullptr : found->second;
    if (found != now.end()) now.erase(found);
    if (node && node->object == old.object && node->selection == old.selection) continue;
    change.names.push_back(old.name);
    change.selected_before += selected_of(old);
    if (old.object) change.triangles_before += old.object->triangle_count();
    if (!node) continue;
    change.selected_after += selected_of(*node);
    if (selected_of(*node) > 0) change.with_selected.push_back(node->name);
    if (node->object) change.triangles_after += node->object->triangle_count();
  }
  for (const PlacedNode& placed : placed_nodes(after))
    if (now.contains(placed.node->id)) change.added.push_back(placed.node->name);
  return change;
}

// Number of cage points whose translation differs from that in `replaced` (if not null). 0 if an edit does not list its
// points by number.
std::size_t moved_points(const CageDeform& edit, const CageDeform* replaced) {
  std::map<std::uint64_t, Vec3> motions, known;
  const auto collect = [](const CageDeform& from, std::map<std::uint64_t, Vec3>& into) {
    for (const CageMove& move : from.moves) {
      if (move.points.ranges.empty()) return false;
      for (const auto& [first, last] : move.points.ranges)
        for (std::uint64_t k = first; k <= last; ++k) into[k] = move.translate;
    }
    return true;
  };
  if (!collect(edit, motions) || (replaced != nullptr && !collect(*replaced, known))) return 0;
  std::size_t moved = 0;
  for (const auto& [k, motion] : motions) moved += !known.contains(k) || known.at(k) != motion ? 1 : 0;
  for (const auto& [k, motion] : known) moved += motions.contains(k) ? 0 : 1;
  return moved;
}

std::vector<std::string> named(const std::vector<Edit>& group, const Scene& before, const Scene& after) {
  std::vector<std::string> names;
  std::set<NodeId> seen;
  for (const Edit& edit : group)
    for (const NodeId id : edit.type().named_nodes(edit.value())) {
      if (!seen.insert(id).second) continue;
      NodePtr node = find(before, id);
      if (!node) node = find(after, id);
      if (node) names.push_back(node->name);
    }
  return names;
}

}  // namespace

std::string title_of(const std::vector<Edit>& group, const Scene& before, const Scene& after, const Edit* replaced) {
  if (group.empty()) return "";
  const Edit& first = group.front();
  if (std::string said = first.type().title(first.value()); !said.empty()) {
    if (group.size() > 1) said += fmt::format(" and {} more", group.size() - 1);
    return said;
  }
  const Change change = change_between(before, after);
  if (first.type().selects) {
    if (change.names.empty()) return "Selection unchanged";
    if (change.selected_after == 0)
      return "Deselected " + amount(change.selected_before) + " in " + together(change.names);
    const std::string where = " in " + together(change.with_selected);
    if (change.selected_before == 0) return "Selected " + amount(change.selected_after) + where;
    return fmt::format("Selected {}{} ({}{})", amount(change.selected_after), where,
                       change.selected_after >= change.selected_before ? "+" : "−",
                       change.selected_after >= change.selected_before
                           ? change.selected_after - change.selected_before
                           : change.selected_before - change.selected_after);
  }
  if (first.is<DeleteSelected>())
    return "Deleted " + amount(change.triangles_before - change.triangles_after) + " of " + together(change.names);
  if (first.is<Separate>()) return "Separated " + amount(change.selected_before) + " as " + together(change.added);
  if (first.is<Erase>()) return "Erased in " + together(change.names);
  if (first.is<Slim>())
    return "Slimmed " + together(change.names) + " by " + amount(change.triangles_before - change.triangles_after);
  if (const auto* cage = first.as<CageDeform>()) {
    const std::size_t moved = moved_points(*cage, replaced == nullptr ? nullptr : replaced->as<CageDeform>());
    if (moved > 0)
      return fmt::format("Moved {} cage point{} of {}", moved, moved == 1 ? "" : "s", together(change.names));
  }
  const std::string done = first.type().done(first.value());
  const auto* transform = first.as<Transform>();
  if (first.type().deforms || (transform != nullptr && transform->selection)) {
    const std::string of = together(change.names);
    const bool part = change.selected_before > 0 && (transform == nullptr || transform->selection);
    return done + " " + (part ? amount(change.selected_before) + " of " : "") + of;
  }
  if (first.type().makes_nodes) {
    const std::string of = together(named(group, before, after));
    return done + " " + of + (change.added.empty() ? "" : " as " + together(change.added));
  }
  const std::vector<std::string> names = named(group, before, after);
  return done + " " + together(names.empty() ? change.names : names);
}

std::string title_of(const std::vector<Edit>& group, const Scene& later) {
  if (group.empty()) return "";
  const Edit& first = group.front();
  if (std::string said = first.type().title(first.value()); !said.empty()) return said;
  const std::string of = together(named(group, later, later));
  if (first.type().selects) return "Selected triangles" + (of.empty() ? "" : " in " + of);
  if (first.is<DeleteSelected>()) return "Deleted the selected triangles" + (of.empty() ? "" : " in " + of);
  return first.type().done(first.value()) + " " + (of.empty() ? "the selection" : of);
}

}  // namespace rebake
