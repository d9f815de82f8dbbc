#include <imgui.h>

#include "editor/gui/panels/panels.h"

namespace rebake {

void draw_log(const Messages& messages) {
  for (const Messages::Line& line : messages.log)
    if (line.failed)
      ImGui::TextColored({1, 0.5F, 0.4F, 1}, "%s", line.text.c_str());
    else
      ImGui::TextWrapped("%s", line.text.c_str());
}

}  // namespace rebake
