#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "editor/edits/nodes/hide.h"
#include "editor/edits/nodes/lock.h"
#include "editor/edits/nodes/rename.h"
#include "editor/edits/nodes/reorder.h"
#include "editor/edits/nodes/show.h"
#include "editor/edits/nodes/unlock.h"
#include "editor/edits/support.h"
#include "editor/gui/panels/panels.h"
#include "editor/gui/state/commands.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/icons.h"
#include "editor/gui/ui/widgets.h"
#include "mesh_ops/base/counted.h"

namespace rebake {

namespace {

// A count in short form: 12345 as 12.3k.
std::string rounded(double value) {
  if (value < 1000) return fmt::format("{:.0f}", value);
  if (value < 1e6) return fmt::format("{:.{}f}k", value / 1e3, value < 1e5 ? 1 : 0);
  return fmt::format("{:.{}f}M", value / 1e6, value < 1e8 ? 1 : 0);
}

Reorder dropped_on(const Scene& scene, NodeId dragged, const Node& on) {
  Reorder reorder;
  reorder.node = NodeRef{dragged};
  if (!on.object) {  // into a group
    reorder.parent = NodeRef{on.id};
    reorder.index = static_cast<int>(on.children.size());
    return reorder;
  }
  const auto [parent, index] = place_of(scene, on.id);
  reorder.index = static_cast<int>(index);
  if (parent == NodeId::none)
    reorder.top = true;
  else
    reorder.parent = NodeRef{parent};
  return reorder;
}

std::optional<NodeId> dropped_node() {
  std::optional<NodeId> node;
  if (!ImGui::BeginDragDropTarget()) return node;
  if (const ImGuiPayload* payload = ImGui::AcceptDragDropPayload("node"))
    node = *static_cast<const NodeId*>(payload->Data);
  ImGui::EndDragDropTarget();
  return node;
}

}  // namespace

void OutlinerPanel::pick(ToolContext& editor, NodeId id) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool active = editor.active.contains(id);
  if (io.KeyShift && find(editor.scene(), shift_from_) != nullptr) {
    bool inside = false;
    for (const PlacedNode& other : placed_nodes(editor.scene())) {
      const bool end = other.node->id == id || other.node->id == shift_from_;
      if (inside || end) editor.active.insert(other.node->id);
      if (end && id != shift_from_) inside = !inside;
    }
    return;
  }
  if (!io.KeyCtrl) editor.active.clear();
  if (io.KeyCtrl && active)
    editor.active.erase(id);
  else
    editor.active.insert(id);
  shift_from_ = id;
}

void OutlinerPanel::draw_name(ToolContext& editor, const Node& node) {
  if (focus_name_) ImGui::SetKeyboardFocusHere();
  focus_name_ = false;
  ImGui::SetNextItemWidth(-1);
  ImGui::InputText("##name", &name_, ImGuiInputTextFlags_AutoSelectAll);
  if (!ImGui::IsItemDeactivated()) return;
  // Rename whenever the field loses focus; Esc has restored the old name.
  renaming_ = NodeId::none;
  if (name_ == node.name || name_.empty()) return;
  Rename rename;
  rename.node = NodeRef{node.id};
  rename.name = name_;
  editor.edit(rename);
}

// The selectable name, with its tooltip, context menu and drag and drop.
void OutlinerPanel::draw_selectable(ToolContext& editor, DialogState& dialogs, const PlacedNode& placed) {
  const Node& node = *placed.node;
  ImGui::PushStyleColor(ImGuiCol_Text, color(placed.visible ? theme().text : theme().muted));
  const bool active = editor.active.contains(node.id);
  if (active) {
    ImGui::PushStyleColor(ImGuiCol_Text, color(theme().on_accent));
    ImGui::PushStyleColor(ImGuiCol_Header, color(theme().accent));
    ImGui::PushStyleColor(ImGuiCol_HeaderHovered, color(theme().accent));
  }
  const bool clicked = ImGui::Selectable(ui::shortened(node.name, ImGui::GetContentRegionAvail().x).c_str(), active,
                                         ImGuiSelectableFlags_AllowDoubleClick | ImGuiSelectableFlags_SpanAllColumns |
                                             ImGuiSelectableFlags_AllowItemOverlap);
  if (active) ImGui::PopStyleColor(3);
  ImGui::PopStyleColor();
  announce::item("name");
  if (node.object)
    ui::tip(node.name, "",
            fmt::format("{}, {}, {:.1f} MB. Click to pick, double-click to rename, right-click "
                        "for more.",
                        counted(node.object->triangle_count(), "triangle"),
                        counted(node.object->opaque_texel_count(), "opaque texel"),
                        static_cast<double>(node.object->memory()) / 1e6));
  if (clicked && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
    renaming_ = node.id;
    name_ = node.name;
    focus_name_ = true;
    editor.active = {node.id};
  } else if (clicked) {
    pick(editor, node.id);
  }
  if (ImGui::IsItemClicked(ImGuiMouseButton_Right)) {
    if (!editor.active.contains(node.id)) editor.active = {node.id};
    dialogs.context = true;
  }
  if (ImGui::BeginDragDropSource()) {
    ImGui::SetDragDropPayload("node", &node.id, sizeof node.id);
    ImGui::TextUnformatted(node.name.c_str());
    ImGui::EndDragDropSource();
  }
  if (const auto dragged = dropped_node()) editor.edit(dropped_on(editor.scene(), *dragged, node));
}

namespace {

// Toggles for visibility and lock.
void draw_toggles(ToolContext& editor, const Node& node) {
  const NodeRef ref{node.id};
  ImGui::TableNextColumn();
  const bool on_accent = editor.active.contains(node.id);
  if (ui::quiet_icon(node.visible ? icons::eye : icons::eye_off, "Visible", node.visible, on_accent)) {
    if (node.visible)
      editor.edit(Hide{ref});
    else
      editor.edit(Show{ref});
  }
  ui::tip(node.visible ? "Hide" : "Show", command_key("Hide", editor.settings), "Hidden nodes are not exported.");
  ImGui::TableNextColumn();
  if (ui::quiet_icon(node.locked ? icons::lock : icons::lock_open_outline, "Locked", node.locked, on_accent)) {
    if (node.locked)
      editor.edit(Unlock{ref});
    else
      editor.edit(Lock{ref});
  }
  ui::tip(node.locked ? "Unlock" : "Lock", "", "Locked nodes cannot be edited.");
}

}  // namespace

void OutlinerPanel::draw_node(ToolContext& editor, DialogState& dialogs, const PlacedNode& placed, int depth) {
  const Node& node = *placed.node;
  const announce::Part part(node.name);
  ImGui::PushID(static_cast<int>(static_cast<std::uint64_t>(node.id)));
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::Dummy({px(14) * static_cast<float>(depth), 1});
  ImGui::SameLine(0, 0);
  const bool group = !node.children.empty();
  if (group) {
    const bool folded = folded_.contains(node.id);
    if (ui::quiet_icon(folded ? icons::chevron_right : icons::chevron_down, folded ? "Expand" : "Collapse"))
      folded ? (void)folded_.erase(node.id) : (void)folded_.insert(node.id);
  } else {
    ImGui::PushStyleColor(ImGuiCol_Text, color(editor.active.contains(node.id) ? theme().on_accent : theme().muted));
    ImGui::TextUnformatted(node.object ? icons::cube_outline : icons::folder_outline);
    ImGui::PopStyleColor();
  }
  ImGui::SameLine(0, px(6));
  if (renaming_ == node.id) {
    draw_name(editor, node);
  } else {
    draw_selectable(editor, dialogs, placed);
  }
  ImGui::TableNextColumn();
  if (node.object) {
    const std::string text = rounded(static_cast<double>(node.object->triangle_count()));
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x -
                         ImGui::CalcTextSize(text.c_str()).x);
    ImGui::PushStyleColor(ImGuiCol_Text, color(editor.active.contains(node.id) ? theme().on_accent : theme().muted));
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopStyleColor();
  }
  draw_toggles(editor, node);
  ImGui::PopID();
}

void OutlinerPanel::draw(ToolContext& editor, DialogState& dialogs) {
  const Scene& scene = editor.scene();
  const announce::Part part("outline");
  if (std::exchange(document_, editor.now->document) != editor.now->document) {
    renaming_ = shift_from_ = NodeId::none;
    folded_.clear();
  }
  if (scene.roots.empty()) {
    ui::muted("No scene is open.");
    return;
  }
  const auto line = ImGui::GetTextLineHeightWithSpacing();
  if (!ImGui::BeginTable("nodes", 4, ImGuiTableFlags_ScrollY | ImGuiTableFlags_NoPadOuterX,
                         {0, ImGui::GetContentRegionAvail().y - line}))
    return;
  ImGui::TableSetupColumn("node", ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableSetupColumn("triangles", ImGuiTableColumnFlags_WidthFixed, ImGui::CalcTextSize("000.0k").x);
  for (const char* icon : {"visible", "locked"})
    ImGui::TableSetupColumn(icon, ImGuiTableColumnFlags_WidthFixed, px(22));
  std::map<NodeId, int> depths;
  std::set<NodeId> inside_folded;
  std::size_t triangles = 0;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    const NodeId id = placed.node->id;
    if (placed.node->object) triangles += placed.node->object->triangle_count();
    const int depth = depths[id];
    const bool hides = folded_.contains(id) || inside_folded.contains(id);
    for (const NodePtr& child : placed.node->children) {
      depths[child->id] = depth + 1;
      if (hides) inside_folded.insert(child->id);
    }
    if (!inside_folded.contains(id)) draw_node(editor, dialogs, placed, depth);
  }
  // Area below the last node: a click clears the picked nodes, a drop moves a node to the top level.
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  if (ImGui::Selectable("##below", false, ImGuiSelectableFlags_SpanAllColumns, {0, px(40)})) editor.active.clear();
  announce::item("below");
  if (const auto dragged = dropped_node()) {
    Reorder reorder;
    reorder.node = NodeRef{*dragged};
    reorder.top = true;
    reorder.index = static_cast<int>(scene.roots.size());
    editor.edit(reorder);
  }
  ImGui::EndTable();
  const std::string selected = editor.selected_words();
  const std::string all = fmt::format("{}{}{}", counted(triangles, "triangle"), selected.empty() ? "" : ", ", selected);
  ImGui::TextDisabled("%s", ui::shortened(all, ImGui::GetContentRegionAvail().x).c_str());
}

}  // namespace rebake
