#include <fmt/format.h>
#include <imgui.h>

#include "editor/gui/panels/panels.h"

namespace rebake {

void HistoryPanel::draw(Desk& desk) {
  const Snapshot& now = *desk.now;
  const bool fresh = of_ != desk.now;
  if (fresh) {
    of_ = desk.now;
    lines_ = {"Start"};
    done_ = 0;
    bool was_undone = false;
    const auto add = [&](const Edit& edit, bool joined, bool undone) {
      const std::string title = title_of(edit, now.scene);
      // What was made together can have been undone in parts, by a script.
      if (joined && undone == was_undone) {
        // Many are one line still.
        constexpr std::size_t longest = 80;
        if (lines_.back().size() < longest) lines_.back() += ", " + title;
        return;
      }
      was_undone = undone;
      lines_.push_back(fmt::format("{}  {}{}", lines_.size(), undone ? "(undone) " : "", title));
      if (!undone) ++done_;
    };
    for (std::size_t k = 0; k < now.done.size(); ++k) add(now.done[k], now.joined[k], false);
    for (std::size_t k = 0; k < now.undone.size(); ++k) add(now.undone[k], now.joined[now.done.size() + k], true);
  }
  for (int k = 0; k < static_cast<int>(lines_.size()); ++k) {
    const ImGuiCol_ color = k <= done_ ? ImGuiCol_Text : ImGuiCol_TextDisabled;
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(color));
    const bool clicked = ImGui::Selectable(lines_[static_cast<std::size_t>(k)].c_str(), k == done_);
    ImGui::PopStyleColor();
    if (k == done_ && fresh) ImGui::SetScrollHereY(0.8F);
    if (clicked && k < done_) desk.undo(done_ - k);
    if (clicked && k > done_) desk.redo(k - done_);
  }
}

}  // namespace rebake
