#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <utility>

#include "editor/edits/nodes/remove_view.h"
#include "editor/edits/nodes/rename_view.h"
#include "editor/edits/stored_view.h"
#include "editor/gui/panels/panels.h"
#include "editor/gui/state/commands.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/icons.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

namespace {

void look_through(ToolContext& editor, const std::string& name) { editor.view.camera = editor.scene().views.at(name); }

// Whether the camera shows the stored view. Near and far planes do not count, since they follow the scene.
bool looks_from(const Camera& camera, const Camera& stored) {
  if (camera.orthographic() != stored.orthographic() || camera.target != stored.target) return false;
  const double away = (stored.eye - stored.target).norm();
  return camera.orthographic()
             ? camera.ortho_height == stored.ortho_height &&
                   (camera.eye - camera.target).normalized().isApprox((stored.eye - stored.target).normalized(), 1e-9)
             : (camera.eye - stored.eye).norm() < 1e-9 * away;
}

}  // namespace

void ViewsPanel::draw_name(ToolContext& editor, const std::string& name, float width) {
  if (renaming_ != name) {
    ImGui::TextUnformatted(ui::shortened(name, width - px(52)).c_str());
    return;
  }
  if (std::exchange(focus_name_, false)) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(width - px(52));
  ImGui::InputText("##name", &name_, ImGuiInputTextFlags_AutoSelectAll);
  if (!ImGui::IsItemDeactivated()) return;
  renaming_.clear();
  if (name_ != name && !name_.empty()) editor.edit(RenameView{name, name_});
}

void ViewsPanel::draw_card(ToolContext& editor, const Scene& drawn, Thumbnails& thumbnails, const std::string& name) {
  const ImVec2 size{px(160), px(100)};
  const announce::Part part(name);
  ImGui::PushID(name.c_str());
  ImGui::BeginGroup();
  const ImVec2 at = ImGui::GetCursorScreenPos(), end{at.x + size.x, at.y + size.y};
  const bool clicked = ImGui::InvisibleButton("picture", size);
  announce::item("picture");
  const bool hovered = ImGui::IsItemHovered(), here = looks_from(editor.view.camera, editor.scene().views.at(name));
  if (hovered && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
    renaming_ = name_ = name;
    focus_name_ = true;
  } else if (clicked) {
    look_through(editor, name);
  }
  ui::tip(name, "", "Click to move the camera there, double-click to rename.");
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(at, end, color32(theme().field), px(4));
  if (const unsigned texture = thumbnails.of_view(drawn, name))
    list.AddImageRounded(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)), at, end, {0, 0}, {1, 1},
                         IM_COL32_WHITE, px(4));
  if (hovered || here) list.AddRect(at, end, color32(theme().accent), px(4), 0, px(2));
  draw_name(editor, name, size.x);
  ImGui::SameLine(size.x - px(46));
  if (ui::quiet_icon(icons::camera, "Update view")) store_view(editor, name);
  ui::tip("Update view", "", "Replaces this view by the current one: " + name + ".");
  ImGui::SameLine(size.x - px(22));
  if (ui::quiet_icon(icons::trash, "Delete")) editor.edit(RemoveView{name});
  ui::tip("Delete", "", "Deletes " + name + "; undo restores it.");
  ImGui::EndGroup();
  ImGui::PopID();
}

void ViewsPanel::draw(ToolContext& editor, const Scene& drawn, Thumbnails& thumbnails) {
  const announce::Part part("views");
  if (editor.scene().roots.empty()) {
    ui::muted("No scene is open.");
    return;
  }
  if (ui::button("Store view##store-view")) store_view(editor);
  ui::hint("Views are saved with the scene. Click one to move the camera there.");
  const float card = px(160) + px(14), room = ImGui::GetContentRegionAvail().x;
  const int across = std::max(1, static_cast<int>(room / card));
  int number = 0;
  for (const std::string& name : view_names(editor.scene())) {
    if (number % across != 0) ImGui::SameLine(0, px(14));
    draw_card(editor, drawn, thumbnails, name);
    ++number;
  }
}

}  // namespace rebake
