#include <imgui.h>

#include <filesystem>

#include "editor/document/sample_folder.h"
#include "editor/gui/panels/panels.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/fonts.h"
#include "editor/gui/ui/icons.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// Draws a recent path as a card with its thumbnail, or with an icon if `picture` is 0.
void card(EditorContext& editor, unsigned picture, const std::string& path, const ImVec2& size) {
  const std::string name = fs::path(path).filename().string();
  ImGui::PushID(path.c_str());
  ImGui::BeginGroup();
  const ImVec2 at = ImGui::GetCursorScreenPos(), end{at.x + size.x, at.y + size.y};
  if (ImGui::InvisibleButton("card", size)) editor.project.open({path});
  announce::item(name);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(at, end, color32(theme().field), px(4));
  if (picture != 0)
    list.AddImageRounded(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(picture)), at, end, {0, 0}, {1, 1},
                         IM_COL32_WHITE, px(4));
  else
    list.AddText({at.x + size.x / 2 - ImGui::GetFontSize() / 2, at.y + size.y / 2 - ImGui::GetFontSize() / 2},
                 color32(theme().muted), icons::cube_outline);
  if (ImGui::IsItemHovered()) list.AddRect(at, end, color32(theme().accent), px(4), 0, px(2));
  ui::tip(name, "", path);
  ImGui::TextUnformatted(ui::shortened(name, size.x).c_str());
  ImGui::EndGroup();
  ImGui::PopID();
}

void entry(EditorContext& editor, const char* icon, const std::string& path) {
  const fs::path file(path);
  const std::string name = file.filename().string();
  ImGui::PushID(path.c_str());
  if (ImGui::Selectable((std::string(icon) + "   " + name).c_str(), false, 0, {0, px(26)})) editor.project.open({path});
  ImGui::PopID();
  announce::item(name);
  ui::tip(name, "", path);
}

}  // namespace

void draw_start(EditorContext& editor, Thumbnails& thumbnails, const ImVec2& middle) {
  if (!editor.scene().roots.empty() || editor.jobs.worker.busy() || editor.beside || editor.dialogs.training) return;
  const float width = px(420);
  ImGui::SetNextWindowPos(middle, ImGuiCond_Always, {0.5F, 0.5F});
  ImGui::SetNextWindowSizeConstraints({width, 0}, {width, px(520)});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, color(theme().panel));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, px(10));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {px(24), px(22)});
  ImGui::Begin("start", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::PopStyleVar(2);
  ImGui::PopStyleColor();
  const announce::Part part("start");
  ImGui::PushFont(fonts().heading);
  ImGui::TextUnformatted("Open a scene");
  ImGui::PopFont();
  if (!editor.now->done.empty()) ui::muted("The scene is empty. Undo restores removed nodes.");
  ui::muted("Drop folders here, or choose them. Several scenes can be combined.");
  ImGui::Dummy({0, px(6)});
  if (ui::primary_button("Open...", {px(140), px(34)})) editor.dialogs.path = FileDialogPurpose::open;
  std::error_code error;
  std::vector<std::string> recent;
  for (const std::string& path : editor.settings.recent)
    if (recent.size() < 6 && fs::exists(path, error)) recent.push_back(path);
  if (!recent.empty()) {
    ImGui::Dummy({0, px(8)});
    ImGui::TextDisabled("Recent");
    const announce::Part inside("recent");
    const float gap = px(10), across = (ImGui::GetContentRegionAvail().x - 2 * gap) / 3;
    for (std::size_t k = 0; k < recent.size(); ++k) {
      if (k % 3 != 0) ImGui::SameLine(0, gap);
      card(editor, thumbnails.of_file(recent[k]), recent[k], {across, across * 0.625F});
    }
  }
  ImGui::Dummy({0, px(8)});
  ImGui::TextDisabled("Samples");
  const announce::Part inside("samples");
  for (fs::directory_iterator at(sample_folder(), error), end; !error && at != end; at.increment(error))
    if (at->is_directory(error)) entry(editor, icons::cube_outline, at->path().string());
  ImGui::End();
}

}  // namespace rebake
