#include <fmt/format.h>
#include <imgui.h>

#include "editor/gui/panels.h"

namespace rebake {

void draw_history(Desk& desk) {
  const Snapshot& now = *desk.now;
  const int done = static_cast<int>(now.done.size());
  if (ImGui::Selectable("start", done == 0) && done > 0) desk.undo(done);
  for (int k = 0; k < done; ++k) {
    const std::string title = fmt::format("{}  {}", k + 1, title_of(now.done[static_cast<std::size_t>(k)], now.scene));
    if (ImGui::Selectable(title.c_str(), k + 1 == done) && k + 1 < done) desk.undo(done - k - 1);
  }
  for (int k = 0; k < static_cast<int>(now.undone.size()); ++k) {
    const std::string title =
        fmt::format("{}  {} (undone)", done + k + 1, title_of(now.undone[static_cast<std::size_t>(k)], now.scene));
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    const bool clicked = ImGui::Selectable(title.c_str());
    ImGui::PopStyleColor();
    if (clicked) desk.redo(k + 1);
  }
}

}  // namespace rebake
