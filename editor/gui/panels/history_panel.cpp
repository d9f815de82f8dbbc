#include <fmt/format.h>
#include <imgui.h>

#include "editor/gui/panels/panels.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/style.h"

namespace rebake {

void HistoryPanel::draw(DocumentEditor& editor) {
  const Snapshot& now = *editor.now;
  const announce::Part part("history");
  const bool fresh = std::exchange(of_, editor.now) != editor.now;
  const int done = static_cast<int>(now.steps_done), all = static_cast<int>(now.steps.size());
  for (int k = 0; k <= all; ++k) {
    const std::string title = k == 0 ? "Start" : now.steps[static_cast<std::size_t>(k - 1)].title;
    ImGui::PushID(k);
    ImGui::PushStyleColor(ImGuiCol_Text, color(k <= done ? theme().text : theme().muted));
    const bool clicked = ImGui::Selectable(fmt::format("{:>3}   {}", k, title).c_str(), k == done);
    ImGui::PopStyleColor();
    ImGui::PopID();
    announce::item(fmt::format("{}", k));
    if (k == done && fresh) ImGui::SetScrollHereY(0.8F);
    if (clicked && k != done) editor.go_to(static_cast<std::size_t>(k));
  }
}

}  // namespace rebake
