#include <fmt/format.h>
#include <imgui.h>

#include "editor/gui/panels.h"

namespace rebake {

void HistoryPanel::draw(Desk& desk) {
  const Snapshot& now = *desk.now;
  const int done = static_cast<int>(now.done.size());
  const bool fresh = of_ != desk.now;
  if (fresh) {
    of_ = desk.now;
    lines_ = {"start"};
    for (const Edit& edit : now.done) lines_.push_back(fmt::format("{}  {}", lines_.size(), title_of(edit, now.scene)));
    for (const Edit& edit : now.undone)
      lines_.push_back(fmt::format("{}  {} (undone)", lines_.size(), title_of(edit, now.scene)));
  }
  for (int k = 0; k < static_cast<int>(lines_.size()); ++k) {
    const ImGuiCol_ color = k <= done ? ImGuiCol_Text : ImGuiCol_TextDisabled;
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(color));
    const bool clicked = ImGui::Selectable(lines_[static_cast<std::size_t>(k)].c_str(), k == done);
    ImGui::PopStyleColor();
    if (k == done && fresh) ImGui::SetScrollHereY(0.8F);
    if (clicked && k < done) desk.undo(done - k);
    if (clicked && k > done) desk.redo(k - done);
  }
}

}  // namespace rebake
