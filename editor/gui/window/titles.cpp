#include "editor/gui/window/titles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "editor/edits/deform/bend.h"
#include "editor/edits/deform/cage.h"
#include "editor/edits/deform/handles.h"
#include "editor/edits/deform/stretch.h"
#include "editor/edits/deform/taper.h"
#include "editor/edits/deform/twist.h"
#include "editor/edits/nodes/duplicate.h"
#include "editor/edits/nodes/ground.h"
#include "editor/edits/nodes/group.h"
#include "editor/edits/nodes/import.h"
#include "editor/edits/nodes/light.h"
#include "editor/edits/nodes/merge.h"
#include "editor/edits/nodes/remove_view.h"
#include "editor/edits/nodes/rename.h"
#include "editor/edits/nodes/rename_view.h"
#include "editor/edits/nodes/reorder.h"
#include "editor/edits/nodes/transform.h"
#include "editor/edits/nodes/view.h"
#include "editor/edits/shape/delete_selected.h"
#include "editor/edits/shape/erase.h"
#include "editor/edits/shape/separate.h"
#include "editor/edits/shape/slim.h"
#include "editor/edits/support.h"
#include "mesh_ops/formats/formats.h"

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

std::string verb_of(const Edit& edit) {
  static const std::map<std::string, const char*> verbs = {{"hide", "Hid"},
                                                           {"show", "Showed"},
                                                           {"lock", "Locked"},
                                                           {"unlock", "Unlocked"},
                                                           {"remove", "Removed"},
                                                           {"duplicate", "Copied"},
                                                           {"merge", "Merged"},
                                                           {"group", "Grouped"},
                                                           {"reorder", "Moved in the outline:"},
                                                           {"place", "Placed"},
                                                           {"drop", "Dropped"},
                                                           {"align", "Aligned"},
                                                           {"fill", "Filled holes of"}};
  if (const auto* transform = edit.as<Transform>()) {
    const bool turns = !transform->rotate.matrix().isIdentity(0), scales = transform->scale.value != Vec3::Ones();
    return turns && !scales ? "Rotated" : scales && !turns ? "Scaled" : scales ? "Rotated and scaled" : "Moved";
  }
  if (const auto* bend = edit.as<Bend>()) return fmt::format("Bent by {:.4g}°:", bend->degrees);
  if (const auto* twist = edit.as<Twist>()) return fmt::format("Twisted by {:.4g}°:", twist->degrees);
  if (const auto* taper = edit.as<Taper>()) return fmt::format("Tapered by {:.4g}:", taper->factor);
  if (const auto* stretch = edit.as<Stretch>()) return fmt::format("Stretched by {:.4g}:", stretch->factor);
  if (edit.is<CageDeform>()) return "Deformed by a cage:";
  if (edit.is<HandlesDeform>()) return "Deformed by handles:";
  if (const auto found = verbs.find(edit.type().op); found != verbs.end()) return found->second;
  std::string words = edit.type().op;
  std::replace(words.begin(), words.end(), '_', ' ');
  words[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
  return words + ":";
}

// Titles of edits that do not act on the triangles of nodes; empty for others.
std::string special(const Edit& edit) {
  if (const auto* import = edit.as<Import>()) return "Imported " + folder_title(import->path);
  if (const auto* light = edit.as<LightEdit>(); light != nullptr && light->light_source() == "picture")
    return "Light from " + std::filesystem::path(light->picture).filename().string();
  if (edit.is<GroundEdit>()) return "Set the ground plane";
  if (const auto* view = edit.as<StoreView>()) return "Stored the view \"" + view->name + "\"";
  if (const auto* view = edit.as<RenameView>())
    return "Renamed the view \"" + view->name + "\" to \"" + view->to + "\"";
  if (const auto* view = edit.as<RemoveView>()) return "Removed the view \"" + view->name + "\"";
  if (const auto* light = edit.as<LightEdit>())
    return light->effects == std::vector<std::string>{"none"} ? "Light stays as baked" : "Light follows edits";
  if (const auto* rename = edit.as<Rename>()) return "Renamed to \"" + rename->name + "\"";
  return "";
}

bool deforms(const Edit& edit) {
  return edit.is<Bend>() || edit.is<Twist>() || edit.is<Taper>() || edit.is<Stretch>() || edit.is<CageDeform>() ||
         edit.is<HandlesDeform>();
}

}  // namespace

std::string title_of(const std::vector<Edit>& group, const Scene& before, const Scene& after, const Edit* replaced) {
  if (group.empty()) return "";
  const Edit& first = group.front();
  if (std::string said = special(first); !said.empty()) {
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
  const auto* transform = first.as<Transform>();
  if (deforms(first) || (transform != nullptr && transform->selection)) {
    const std::string of = together(change.names);
    const bool part = change.selected_before > 0 && (transform == nullptr || transform->selection);
    return verb_of(first) + " " + (part ? amount(change.selected_before) + " of " : "") + of;
  }
  if (first.is<Duplicate>() || first.is<Group>() || first.is<Merge>()) {
    const std::string of = together(named(group, before, after));
    return verb_of(first) + " " + of + (change.added.empty() ? "" : " as " + together(change.added));
  }
  return verb_of(first) + " " + together(named(group, before, after));
}

std::string title_of(const std::vector<Edit>& group, const Scene& later) {
  if (group.empty()) return "";
  const Edit& first = group.front();
  if (std::string said = special(first); !said.empty()) return said;
  const std::string of = together(named(group, later, later));
  if (first.type().selects) return "Selected triangles" + (of.empty() ? "" : " in " + of);
  if (first.is<DeleteSelected>()) return "Deleted the selected triangles" + (of.empty() ? "" : " in " + of);
  return verb_of(first) + " " + (of.empty() ? "the selection" : of);
}

}  // namespace rebake
