#include <imgui.h>

#include <string_view>
#include <utility>

#include "editor/gui/panels/panels.h"
#include "editor/gui/state/commands.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/fonts.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

namespace {

constexpr std::pair<const char*, const char*> pointer_lines[] = {
    {"Middle button", "Orbit"},
    {"Shift + middle, or right button", "Pan"},
    {"Wheel", "Zoom to cursor"},
    {"Alt + left button", "Orbit with any tool"},
    {"Double click", "Set the orbit centre"},
    {"Right click", "Context menu"},
    {"Shift, Ctrl, both", "Add, remove, intersect"},
    {"Alt + drag a handle of Move", "Duplicate and move"},
    {"X, Y, Z during a drag", "Constrain to the axis; with Shift to its plane"},
    {"Ctrl + drag beside a cage", "Select its points by a lasso"},
    {"Digits during a drag", "Type the amount"},
    {"Esc", "Cancel the drag, or clear the picked nodes"},
};

void line(const std::string& key, const std::string& what) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextWrapped("%s", what.c_str());
  ImGui::TableNextColumn();
  ImGui::PushStyleColor(ImGuiCol_Text, color(theme().accent_text));
  ImGui::TextWrapped("%s", key.c_str());
  ImGui::PopStyleColor();
}

}  // namespace

void draw_keys_sheet(DialogState& dialogs, const Settings& settings) {
  if (!dialogs.keys) return;
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5F, 0.5F});
  ImGui::SetNextWindowSize({std::min(px(900), screen.x - px(40)), std::min(px(620), screen.y - px(60))});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, color(theme().popup));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, px(8));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {px(18), px(16)});
  ImGui::Begin("Keyboard and mouse", &dialogs.keys,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings);
  ImGui::PopStyleVar(2);
  ImGui::PopStyleColor();
  const announce::Part part("keys");
  ImGui::PushFont(fonts().heading);
  ImGui::TextUnformatted("Keyboard and mouse");
  ImGui::PopFont();
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - px(90));
  if (ui::button("Close", {px(90), 0})) dialogs.keys = false;
  ImGui::BeginChild("columns", {0, 0}, false);
  const int columns = ImGui::GetContentRegionAvail().x > px(640) ? 2 : 1;
  if (ImGui::BeginTable("sheet", columns, ImGuiTableFlags_SizingStretchSame)) {
    int group = 0;
    const auto begin = [&](const char* name) {
      if (group++ % columns == 0) ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::Dummy({0, px(4)});
      ImGui::TextDisabled("%s", name);
      if (!ImGui::BeginTable(name, 2)) return false;
      ImGui::TableSetupColumn("what", ImGuiTableColumnFlags_WidthStretch, 1.1F);
      ImGui::TableSetupColumn("key", ImGuiTableColumnFlags_WidthStretch, 1);
      return true;
    };
    if (begin("Pointer")) {
      for (const auto& [key, what] : pointer_lines) line(key, what);
      ImGui::EndTable();
    }
    for (const char* menu : {"File", "Edit", "Select", "Tool", "View", "Window"}) {
      if (!begin(menu)) continue;
      for (const Command& command : command_table())
        if (command.menu == std::string_view(menu) && *command.keys_of(settings) != '\0')
          line(key_names(command.keys_of(settings)).c_str(), command.title);
      ImGui::EndTable();
    }
    ImGui::EndTable();
  }
  ImGui::EndChild();
  ImGui::End();
}

}  // namespace rebake
