// What tools and commands work on: the picked nodes and the selection.
#include "editor/gui/state/document_editor.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "editor/edits/select/select_picture.h"
#include "editor/edits/support.h"

namespace rebake {

std::vector<NodeId> DocumentEditor::active_tops() const {
  std::vector<NodeId> tops;
  for (const NodeId id : active) {
    bool below = false;
    for (NodeId parent = parent_of(scene(), id); parent != NodeId::none && !below; parent = parent_of(scene(), parent))
      below = active.contains(parent);
    if (!below) tops.push_back(id);
  }
  return tops;
}

Box DocumentEditor::focus() const {
  Box box;
  for (const NodeId id : active) box.extend(subtree_bounds(scene(), id));
  return box.isEmpty() ? world_bounds(shown()) : box;
}

std::vector<std::optional<NodeRef>> DocumentEditor::scope(bool selected) const {
  if (active.empty()) return {std::nullopt};
  std::vector<std::optional<NodeRef>> nodes;
  for (const PlacedNode& placed : placed_nodes(scene())) {
    if (!placed.node->object) continue;
    if (selected && !selected_.contains(placed.node->id)) continue;
    if (in_scope(placed)) nodes.emplace_back(NodeRef{placed.node->id});
  }
  return nodes;
}

std::set<NodeId> DocumentEditor::nodes_in_scope(bool selected) const {
  std::set<NodeId> nodes;
  for (const PlacedNode& placed : placed_nodes(scene()))
    if (in_scope(placed) && (!selected || selected_.contains(placed.node->id))) nodes.insert(placed.node->id);
  return nodes;
}

std::vector<NodeRef> DocumentEditor::selected_nodes_if_picked() const {
  std::vector<NodeRef> nodes;
  if (active.empty()) return nodes;
  for (const NodeId node : nodes_in_scope(true)) nodes.push_back(NodeRef{node});
  return nodes;
}

bool DocumentEditor::in_scope(const Scene& in, const PlacedNode& placed) const {
  return in_scope_of(active, in, placed);
}

bool DocumentEditor::in_scope_of(const std::set<NodeId>& picks, const Scene& in, const PlacedNode& placed) {
  return placed.node->object && placed.visible && !placed.locked && is_picked(picks, in, placed.node->id);
}

bool DocumentEditor::is_picked(const std::set<NodeId>& picks, const Scene& in, NodeId node) {
  bool inside = picks.empty() || picks.contains(node);
  for (NodeId up = parent_of(in, node); up != NodeId::none && !inside; up = parent_of(in, up))
    inside = picks.contains(up);
  return inside;
}

void DocumentEditor::say_why_nothing(bool needs_selection) {
  messages.say(nodes_in_scope().empty() ? "There is no visible, unlocked object " + scope_words() + "."
               : needs_selection        ? "Nothing is selected " + scope_words() + "."
                                        : "There is nothing to edit " + scope_words() + ".");
}

std::size_t DocumentEditor::selected_triangles() const {
  std::size_t triangles = 0;
  if (selected_.empty()) return triangles;
  for (const PlacedNode& placed : placed_nodes(scene()))
    if (const auto found = selected_.find(placed.node->id); found != selected_.end() && in_scope(placed))
      triangles += found->second;
  return triangles;
}

std::vector<NodeId> DocumentEditor::selected_out_of_scope() const {
  std::vector<NodeId> nodes;
  if (selected_.empty()) return nodes;
  for (const PlacedNode& placed : placed_nodes(scene()))
    if (selected_.contains(placed.node->id) && !in_scope(placed)) nodes.push_back(placed.node->id);
  return nodes;
}

std::string DocumentEditor::selected_words() const {
  std::size_t here = 0, untouchable = 0, elsewhere = 0;
  for (const PlacedNode& placed : placed_nodes(scene())) {
    const auto found = selected_.find(placed.node->id);
    if (found == selected_.end()) continue;
    (in_scope(placed) ? here : is_picked(active, scene(), placed.node->id) ? untouchable : elsewhere) += found->second;
  }
  if (here + untouchable + elsewhere == 0) return "";
  std::string words = fmt::format("{} selected", here);
  if (!active.empty()) words += " " + scope_words();
  if (untouchable > 0) words += fmt::format(", {} hidden or locked", untouchable);
  if (elsewhere > 0) words += fmt::format(", {} elsewhere", elsewhere);
  return words;
}

std::string DocumentEditor::scope_words() const {
  if (active.empty()) return "in the scene";
  const NodePtr only = active.size() == 1 ? find(scene(), *active.begin()) : nullptr;
  return only ? "in " + only->name : fmt::format("in {} picked", active.size());
}

std::vector<DeformTarget> DocumentEditor::deform_targets(std::set<NodeId>* moved) const {
  std::vector<DeformTarget> targets;
  const auto nodes = scope(true);
  if (selected_triangles() > 0)
    for (const std::optional<NodeRef>& node : nodes) {
      targets.emplace_back();
      targets.back().node = node;
      targets.back().selection = true;
    }
  if (!targets.empty()) {
    if (moved != nullptr) *moved = nodes_in_scope(true);
    return targets;
  }
  std::set<NodeId> inside;
  std::map<NodeId, NodeId> top_of;  // picked nodes, or roots, of the nodes inside them
  for (const PlacedNode& placed : placed_nodes(scene())) {
    const NodeId id = placed.node->id;
    if (!top_of.contains(id) && !active.empty() && !active.contains(id)) continue;
    const NodeId top = top_of.try_emplace(id, id).first->second;
    for (const NodePtr& child : placed.node->children) top_of[child->id] = top;
    if (!placed.node->object || !placed.visible || placed.locked) continue;
    inside.insert(id);
    if (!targets.empty() && targets.back().node->id == top) continue;
    targets.emplace_back();
    targets.back().node = NodeRef{top};
  }
  // Do not guess among several nodes.
  if (active.empty() && targets.size() > 1) targets.clear();
  if (moved != nullptr && !targets.empty()) *moved = std::move(inside);
  return targets;
}

std::optional<DeformTarget> DocumentEditor::one_deform_target() {
  const std::vector<DeformTarget> targets = deform_targets();
  if (targets.empty()) {
    if (active.empty() && nodes_in_scope().size() > 1)
      messages.say("There are several objects. Pick the one to deform, or select triangles.");
    else
      say_why_nothing(false);
    return std::nullopt;
  }
  if (targets.size() == 1) return targets.front();
  // Without a node, an edit takes all selected triangles of visible, unlocked nodes.
  std::size_t all = 0;
  for (const PlacedNode& placed : placed_nodes(scene()))
    if (placed.node->object && placed.visible && !placed.locked && selected_.contains(placed.node->id)) ++all;
  if (targets.front().selection && all == targets.size()) {
    DeformTarget everything = targets.front();
    everything.node.reset();
    return everything;
  }
  messages.say(targets.front().selection
                   ? "This tool works on one picked node, or on all selected triangles. Pick one node, or none."
                   : "This tool deforms one node and its children. Pick one node.");
  return std::nullopt;
}

std::set<NodeId> DocumentEditor::deform_nodes() const {
  std::set<NodeId> nodes;
  deform_targets(&nodes);
  return nodes;
}

Box DocumentEditor::deform_bounds(const std::vector<DeformTarget>& targets) const {
  Box box;
  for (const DeformTarget& target : targets) {
    if (!target.selection) {
      box.extend(subtree_bounds(scene(), target.node->id));
      continue;
    }
    for (const PlacedNode& placed : placed_nodes(scene()))
      if (placed.visible && !placed.locked && placed.node->selection &&
          (!target.node || target.node->id == placed.node->id))
        box.extend(selection_bounds(placed));
  }
  return box;
}

std::size_t DocumentEditor::visible_selection_count() const {
  std::size_t last = 0;
  std::map<NodeId, bool> begins;  // whether the first of these edits for a node replaced its selection; none: all nodes
  for (auto edit = now->done.rbegin(); edit != now->done.rend(); ++edit, ++last) {
    const auto* picture = edit->as<SelectPicture>();
    if (picture == nullptr || picture->through) break;
    if (picture->mode != SelectMode::set && picture->mode != SelectMode::add) break;
    bool& begun = begins[picture->node ? picture->node->id : NodeId::none];
    if (begun) break;
    begun = picture->mode == SelectMode::set;
  }
  return std::all_of(begins.begin(), begins.end(), [](const auto& one) { return one.second; }) ? last : 0;
}

std::vector<SelectPicture> DocumentEditor::visible_selections() const {
  std::vector<SelectPicture> last;
  for (std::size_t k = now->done.size() - visible_selection_count(); k < now->done.size(); ++k)
    last.push_back(*now->done[k].as<SelectPicture>());
  return last;
}

}  // namespace rebake
