#include <imgui.h>
#include <imgui_stdlib.h>

#include <nlohmann/json.hpp>

#include "editor/gui/panels/panels.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/widgets.h"
#include "editor/script/script.h"
#include "mesh_ops/base/error.h"

namespace rebake {

void ScriptPanel::draw(DocumentEditor& editor, DialogState& dialogs) {
  const announce::Part part("script");
  if (ui::button("Copy")) {
    std::string text;
    for (const Edit& edit : editor.now->done) text += to_json(edit).dump() + "\n";
    ImGui::SetClipboardText(text.c_str());
  }
  ImGui::SameLine();
  if (ui::button("Save...")) dialogs.path = FileDialogPurpose::save_script;
  ImGui::SameLine();
  if (ui::button("Run...")) dialogs.path = FileDialogPurpose::run_script;
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  if (ImGui::InputTextWithHint("##line", "A line, e.g. {\"op\": \"select\", \"all\": true}", &line_,
                               ImGuiInputTextFlags_EnterReturnsTrue) &&
      !line_.empty()) {
    try {
      const ScriptCommand command = read_command(read_line(line_), editor.scene());
      if (const Edit* edit = std::get_if<Edit>(&command))
        editor.edit(*edit);
      else
        editor.jobs.worker.start_change("script line", std::get<Action>(command));
      line_.clear();
      problem_.clear();
    } catch (const nlohmann::json::parse_error& error) {
      problem_ = syntax_error_in(line_, line_, error.byte, error);
    } catch (const nlohmann::json::exception& error) {
      problem_ = "not valid JSON: " + json_error_message(error);
    } catch (const Error& error) {
      problem_ = error.what();
    }
  }
  if (!problem_.empty()) {
    ui::wrapped(problem_, theme().danger);
  }
  ImGui::BeginChild("lines");
  const bool fresh = of_ != editor.now;
  if (fresh) {
    of_ = editor.now;
    lines_.clear();
    for (const Edit& edit : editor.now->done) {
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
