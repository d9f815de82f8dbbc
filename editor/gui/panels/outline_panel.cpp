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

namespace rebake {

namespace {

// A square button with a drawing: `draw(list, middle, radius, color)`.
template <class Draw>
bool icon_button(const char* id, bool on, Draw draw) {
  const float side = ImGui::GetTextLineHeight();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const bool pressed = ImGui::InvisibleButton(id, {side, side});
  const ImU32 color = ImGui::GetColorU32(on || ImGui::IsItemHovered() ? ImGuiCol_Text : ImGuiCol_TextDisabled);
  draw(*ImGui::GetWindowDrawList(), ImVec2{at.x + side / 2, at.y + side / 2}, side * 0.42F, color);
  return pressed;
}

void draw_eye(ImDrawList& list, const ImVec2& middle, float radius, ImU32 color, bool open) {
  const ImVec2 left{middle.x - radius, middle.y}, right{middle.x + radius, middle.y};
  const float high = radius * 1.1F;
  list.AddBezierQuadratic(left, {middle.x, middle.y + high}, right, color, 1.5F);
  if (!open) return;
  list.AddBezierQuadratic(left, {middle.x, middle.y - high}, right, color, 1.5F);
  list.AddCircleFilled(middle, radius * 0.35F, color);
}

void draw_padlock(ImDrawList& list, const ImVec2& middle, float radius, ImU32 color, bool closed) {
  const float top = middle.y - radius * 0.1F, half = radius * 0.7F, lift = closed ? 0 : radius * 0.35F;
  list.AddRectFilled({middle.x - half, top}, {middle.x + half, middle.y + radius}, color, 1);
  list.PathArcTo({middle.x, top - lift}, half * 0.65F, 3.14159F, 2 * 3.14159F, 10);
  list.PathLineTo({middle.x + half * 0.65F, closed ? top : top - lift});
  list.PathStroke(color, 0, 1.5F);
  list.AddLine({middle.x - half * 0.65F, top - lift}, {middle.x - half * 0.65F, top}, color, 1.5F);
}

// 12345 as 12.3k, to be read at a glance.
std::string rounded(double value) {
  if (value < 1000) return fmt::format("{:.0f}", value);
  if (value < 1e6) return fmt::format("{:.{}f}k", value / 1e3, value < 1e5 ? 1 : 0);
  return fmt::format("{:.{}f}M", value / 1e6, value < 1e8 ? 1 : 0);
}

}  // namespace

void OutlinePanel::draw_node(Desk& desk, const PlacedNode& placed, int depth) {
  const Node& node = *placed.node;
  const NodeRef ref{node.id};
  ImGui::PushID(static_cast<int>(static_cast<std::uint64_t>(node.id)));
  const bool shown = node.visible, locked = node.locked;
  if (icon_button("visible", shown, [&](ImDrawList& list, const ImVec2& at, float radius, ImU32 color) {
        draw_eye(list, at, radius, color, shown);
      })) {
    if (shown)
      desk.edit(Hide{ref});
    else
      desk.edit(Show{ref});
  }
  if (ImGui::IsItemHovered()) ImGui::SetTooltip(shown ? "hide" : "show");
  ImGui::SameLine(0, 4);
  if (icon_button("locked", locked, [&](ImDrawList& list, const ImVec2& at, float radius, ImU32 color) {
        draw_padlock(list, at, radius, color, locked);
      })) {
    if (locked)
      desk.edit(Unlock{ref});
    else
      desk.edit(Lock{ref});
  }
  if (ImGui::IsItemHovered()) ImGui::SetTooltip(locked ? "locked: no edit changes it" : "lock");
  ImGui::SameLine(0, 8 + 14 * static_cast<float>(depth));
  if (renaming_ == node.id) {
    if (focus_name_) ImGui::SetKeyboardFocusHere();
    focus_name_ = false;
    ImGui::SetNextItemWidth(-1);
    if (ImGui::InputText("##name", &name_, ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll)) {
      if (name_ != node.name) {
        Rename rename;
        rename.node = ref;
        rename.name = name_;
        desk.edit(rename);
      }
      renaming_ = NodeId::none;
    } else if (ImGui::IsItemDeactivated()) {
      renaming_ = NodeId::none;
    }
  } else {
    const bool active = desk.active.contains(node.id);
    if (ImGui::Selectable(node.name.c_str(), active, ImGuiSelectableFlags_AllowDoubleClick)) {
      const ImGuiIO& io = ImGui::GetIO();
      if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
        renaming_ = node.id;
        name_ = node.name;
        focus_name_ = true;
      } else if (io.KeyShift && find(desk.scene(), shift_from_) != nullptr) {
        bool inside = false;
        for (const PlacedNode& other : placed_nodes(desk.scene())) {
          const bool end = other.node->id == node.id || other.node->id == shift_from_;
          if (inside || end) desk.active.insert(other.node->id);
          if (end && node.id != shift_from_) inside = !inside;
        }
      } else {
        if (!io.KeyCtrl) desk.active.clear();
        if (io.KeyCtrl && active)
          desk.active.erase(node.id);
        else
          desk.active.insert(node.id);
        shift_from_ = node.id;
      }
    }
    if (ImGui::BeginDragDropSource()) {
      ImGui::SetDragDropPayload("node", &node.id, sizeof node.id);
      ImGui::TextUnformatted(node.name.c_str());
      ImGui::EndDragDropSource();
    }
    if (ImGui::BeginDragDropTarget()) {
      if (const ImGuiPayload* payload = ImGui::AcceptDragDropPayload("node")) {
        Reorder reorder;
        reorder.node = NodeRef{*static_cast<const NodeId*>(payload->Data)};
        const auto [parent, index] = place_of(desk.scene(), node.id);
        if (!node.object) {  // into a group
          reorder.parent = ref;
          reorder.index = static_cast<int>(node.children.size());
        } else {
          reorder.index = static_cast<int>(index);
          if (parent == NodeId::none)
            reorder.top = true;
          else
            reorder.parent = NodeRef{parent};
        }
        desk.edit(reorder);
      }
      ImGui::EndDragDropTarget();
    }
  }
  const auto cell = [](const std::string& text) {
    ImGui::TableNextColumn();
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x -
                         ImGui::CalcTextSize(text.c_str()).x);
    ImGui::TextDisabled("%s", text.c_str());
  };
  if (node.object) {
    cell(rounded(static_cast<double>(node.object->triangle_count())));
    cell(rounded(static_cast<double>(node.object->opaque_texel_count())));
    cell(fmt::format("{:.1f}", static_cast<double>(node.object->memory()) / 1e6));
  }
  ImGui::PopID();
}

void OutlinePanel::draw(Desk& desk) {
  const Scene& scene = desk.scene();
  if (scene.roots.empty()) {
    ImGui::TextWrapped("The scene is empty. Drop a folder here, or File > Open.");
    return;
  }
  const auto line = ImGui::GetTextLineHeightWithSpacing();
  if (!ImGui::BeginTable("nodes", 4, ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY | ImGuiTableFlags_NoPadOuterX,
                         {0, ImGui::GetContentRegionAvail().y - line}))
    return;
  const float number = ImGui::CalcTextSize("000.0k").x;
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableSetupColumn("node", ImGuiTableColumnFlags_WidthStretch);
  for (const char* heading : {"tris", "texels", "MB"})
    ImGui::TableSetupColumn(heading, ImGuiTableColumnFlags_WidthFixed, number);
  ImGui::TableHeadersRow();
  std::map<NodeId, int> depths;
  std::size_t triangles = 0;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    const int depth = depths[placed.node->id];
    for (const NodePtr& child : placed.node->children) depths[child->id] = depth + 1;
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    draw_node(desk, placed, depth);
    if (placed.node->object) triangles += placed.node->object->triangle_count();
  }
  ImGui::EndTable();
  ImGui::TextDisabled("%s", fmt::format("{} triangles, {} selected", triangles, desk.selected_triangles()).c_str());
}

}  // namespace rebake
