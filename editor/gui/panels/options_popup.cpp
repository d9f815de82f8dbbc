#include "editor/gui/panels/options_popup.h"

#include <imgui.h>

#include <utility>

#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

void OptionsPopup::draw(const DocumentEditor& editor, const char* help, const std::vector<FieldInfo>& fields,
                        FieldInputs& inputs, const std::string& problem) {
  if (ui::button("Options...##options")) ImGui::OpenPopup("options");
  ui::tip("Options...", "", help);
  ImGui::SetNextWindowSize({px(440), 0});
  open_ = ImGui::BeginPopup("options");
  const bool closes = std::exchange(closes_, false);
  if (!open_) return;
  const announce::Part part("options");
  inputs.draw(editor, fields, problem);
  if (closes) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

bool OptionsPopup::close() {
  closes_ = open_;
  return open_;
}

}  // namespace rebake
