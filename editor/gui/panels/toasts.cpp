#include <imgui.h>

#include "editor/gui/panels/panels.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/icons.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

void draw_toasts(Messages& messages, const ImVec2& corner) {
  const announce::Part part("toast");
  float bottom = corner.y - px(12);
  const std::vector<std::size_t> shown = messages.shown();
  for (auto at = shown.rbegin(); at != shown.rend(); ++at) {
    const Messages::Line& line = messages.log()[*at];
    const float width = px(380);
    ImGui::SetNextWindowPos({corner.x - px(12), bottom}, ImGuiCond_Always, {1, 1});
    ImGui::SetNextWindowSizeConstraints({width, 0}, {width, px(260)});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, color(theme().popup));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, px(6));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1);
    ImGui::Begin(("##toast" + std::to_string(*at)).c_str(), nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing);
    ImGui::PushStyleColor(ImGuiCol_Text, color(line.failed ? theme().danger : theme().accent_text));
    ImGui::TextUnformatted(line.failed ? icons::alert_circle : icons::information_outline);
    ImGui::PopStyleColor();
    ImGui::SameLine();
    ImGui::PushTextWrapPos(width - px(38));
    ImGui::TextUnformatted(line.text.c_str());
    ImGui::PopTextWrapPos();
    announce::item(line.text.substr(0, 60));
    ImGui::SameLine(width - px(32));
    ImGui::SetCursorPosY(px(8));
    if (ui::quiet_icon(icons::close, "Close")) messages.close(*at);
    bottom -= ImGui::GetWindowHeight() + px(8);
    ImGui::End();
    ImGui::PopStyleVar(2);
    ImGui::PopStyleColor();
  }
}

}  // namespace rebake
