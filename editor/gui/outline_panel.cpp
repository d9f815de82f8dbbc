#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "editor/edits/support.h"
#include "editor/gui/panels.h"

namespace rebake {

void OutlinePanel::draw_node(Desk& desk, const PlacedNode& placed, int depth) {
  const Node& node = *placed.node;
  const NodeRef ref{node.id};
  ImGui::PushID(static_cast<int>(static_cast<std::uint64_t>(node.id)));
  bool shown = node.visible, locked = node.locked;
  if (ImGui::Checkbox("##visible", &shown)) {
    if (shown)
      desk.edit(Show{ref});
    else
      desk.edit(Hide{ref});
  }
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("visible");
  ImGui::SameLine();
  if (ImGui::SmallButton(locked ? "L" : "-")) {
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
    if (ImGui::IsItemHovered() && node.object)
      ImGui::SetTooltip("%s",
                        fmt::format("{} triangles, {} opaque texels, {:.1f} MB{}", node.object->triangle_count(),
                                    node.object->opaque_texel_count(), static_cast<double>(node.object->memory()) / 1e6,
                                    node.selection ? fmt::format(", {} selected", count(*node.selection)) : "")
                            .c_str());
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
  ImGui::PopID();
}

void OutlinePanel::draw(Desk& desk) {
  const Scene& scene = desk.scene();
  if (scene.roots.empty()) {
    ImGui::TextWrapped("The scene is empty. Drop a folder here, or File > Open.");
    return;
  }
  std::map<NodeId, int> depths;
  std::size_t triangles = 0;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    const int depth = depths[placed.node->id];
    for (const NodePtr& child : placed.node->children) depths[child->id] = depth + 1;
    draw_node(desk, placed, depth);
    if (placed.node->object) triangles += placed.node->object->triangle_count();
  }
  ImGui::TextDisabled("%s", fmt::format("{} triangles, {} selected", triangles, desk.selected_triangles()).c_str());
}

}  // namespace rebake
