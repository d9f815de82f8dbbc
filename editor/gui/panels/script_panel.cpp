#include <imgui.h>
#include <imgui_stdlib.h>

#include <nlohmann/json.hpp>

#include "editor/gui/panels/panels.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/widgets.h"
#include "editor/script/script.h"
#include "mesh_ops/base/error.h"

namespace rebake {

void ScriptPanel::draw(Desk& desk) {
  const announce::Part part("script");
  if (ui::button("Copy")) {
    std::string text;
    for (const Edit& edit : desk.now->done) text += to_json(edit).dump() + "\n";
    ImGui::SetClipboardText(text.c_str());
  }
  ImGui::SameLine();
  if (ui::button("Save...")) desk.asking.path = PathQuestion::save_script;
  ImGui::SameLine();
  if (ui::button("Run...")) desk.asking.path = PathQuestion::run_script;
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  if (ImGui::InputTextWithHint("##line", "A line, e.g. {\"op\": \"select\", \"all\": true}", &line_,
                               ImGuiInputTextFlags_EnterReturnsTrue) &&
      !line_.empty()) {
    try {
      const ScriptCommand command = read_command(read_line(line_), desk.scene());
      if (const Edit* edit = std::get_if<Edit>(&command))
        desk.edit(*edit);
      else
        desk.jobs.worker.start("script line", std::get<Action>(command));
      line_.clear();
      problem_.clear();
    } catch (const nlohmann::json::exception& error) {
      problem_ = "no valid JSON: " + said_by(error);
    } catch (const Error& error) {
      problem_ = error.what();
    }
  }
  if (!problem_.empty()) {
    ui::wrapped(problem_, theme().danger);
  }
  ImGui::BeginChild("lines");
  const bool fresh = of_ != desk.now;
  if (fresh) {
    of_ = desk.now;
    lines_.clear();
    for (const Edit& edit : desk.now->done) {
      // Shorten long lines, such as regions drawn by hand.
      std::string text = to_json(edit).dump();
      constexpr std::size_t longest = 300;
      if (text.size() > longest) text = text.substr(0, longest) + " ...";
      lines_.push_back(std::move(text));
    }
  }
  for (const std::string& line : lines_) ImGui::TextUnformatted(line.c_str());
  if (fresh) ImGui::SetScrollHereY(1);
  ImGui::EndChild();
}

}  // namespace rebake
