#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "editor/fields/field_info.h"
#include "editor/gui/panels/panels.h"
#include "editor/gui/state/commands.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

namespace {

std::string plain(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return c == '_' ? ' ' : static_cast<char>(std::tolower(c)); });
  return text;
}

// Title of the form of an edit, e.g. "All fields: Select picture…".
std::string form_title(const std::string& op) { return "All fields: " + words_of(op) + "…"; }

struct Entry {
  std::string title, keys, help;
  const Command* command = nullptr;  ///< command to run; null for other entries
  const Camera* view = nullptr;      ///< stored view to look from; null for other entries
  std::string op = {};               ///< edit whose form to open; empty for other entries
};

std::vector<Entry> entries(const EditorContext& editor, const std::string& filter) {
  std::vector<Entry> all;
  for (const Command& command : command_table())
    all.push_back({std::string(command.menu) + ": " + command.title, key_names(command.keys_of(editor.settings)),
                   command.help, &command});
  for (const EditType* type : edit_types())
    all.push_back({form_title(type->op), "", type->help, nullptr, nullptr, type->op});
  for (const auto& [name, camera] : editor.scene().views)
    all.push_back({"Stored view: " + name, "", "", nullptr, &camera});
  // Entries must contain all words, in any order. Underscores count as spaces.
  const std::string wanted = plain(filter);
  std::erase_if(all, [&](const Entry& entry) {
    const std::string text = plain(entry.title + " " + entry.help);
    std::istringstream words(wanted);
    for (std::string word; words >> word;)
      if (text.find(word) == std::string::npos) return true;
    return false;
  });
  // Matches in the title come before matches in the help.
  std::stable_partition(all.begin(), all.end(),
                        [&](const Entry& entry) { return plain(entry.title).find(wanted) != std::string::npos; });
  std::stable_partition(all.begin(), all.end(), [&](const Entry& entry) {
    const std::size_t colon = entry.title.find(": ");
    // Titles that start with the filter come first, with or without the menu: "select" lists the Select menu before the
    // edits of that name.
    return plain(entry.title).starts_with(wanted) ||
           (colon != std::string::npos && plain(entry.title.substr(colon + 2)).starts_with(wanted));
  });
  return all;
}

}  // namespace

void PalettePanel::draw(EditorContext& editor) {
  if (!editor.dialogs.palette) {
    was_open_ = false;
    return;
  }
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({screen.x / 2, screen.y * 0.12F}, ImGuiCond_Always, {0.5F, 0});
  ImGui::SetNextWindowSize({std::min(px(680), screen.x * 0.9F), std::min(px(460), screen.y * 0.7F)});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, color(theme().popup));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, px(8));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {px(12), px(12)});
  ImGui::Begin("Command palette", &editor.dialogs.palette,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings);
  ImGui::PopStyleVar(2);
  ImGui::PopStyleColor();
  const announce::Part part("palette");
  if (!was_open_) {
    filter_.clear();
    ImGui::SetKeyboardFocusHere();
  }
  ImGui::SetNextItemWidth(-1);
  const bool entered = ImGui::InputTextWithHint("##filter", "Type to search; Enter runs the first result", &filter_,
                                                ImGuiInputTextFlags_EnterReturnsTrue);
  announce::item("filter");
  was_open_ = true;
  ImGui::BeginChild("entries");
  bool first = true;
  const float keys_at = ImGui::GetContentRegionAvail().x * 0.48F;
  for (const Entry& entry : entries(editor, filter_)) {
    const bool can = entry.command == nullptr || entry.command->enabled(editor);
    ImGui::BeginDisabled(!can);
    const bool taken = ImGui::Selectable(entry.title.c_str(), first) || (entered && first && can);
    ImGui::EndDisabled();
    announce::item(entry.title);
    if (!entry.keys.empty() || !entry.help.empty()) {
      ImGui::SameLine(keys_at);
      const std::string said = entry.keys.empty() ? entry.help : entry.keys;
      ImGui::TextDisabled("%s", ui::shortened(said, ImGui::GetContentRegionAvail().x).c_str());
    }
    first = false;
    if (!taken) continue;
    editor.dialogs.palette = false;
    if (entry.command != nullptr)
      run_command(editor, *entry.command);
    else if (entry.view != nullptr)
      editor.view.camera = *entry.view;
    else
      editor.dialogs.form = entry.op;
    break;
  }
  ImGui::EndChild();
  // A click outside closes the palette.
  if (ImGui::IsMouseClicked(ImGuiMouseButton_Left) &&
      !ImGui::IsWindowHovered(ImGuiHoveredFlags_ChildWindows | ImGuiHoveredFlags_AllowWhenBlockedByActiveItem))
    editor.dialogs.palette = false;
  ImGui::End();
}

}  // namespace rebake
