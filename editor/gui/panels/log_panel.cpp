#include <imgui.h>

#include "editor/gui/panels/panels.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

void draw_log(const Messages& messages) {
  if (messages.log().empty()) ui::muted("No messages yet.");
  for (const Messages::Line& line : messages.log()) ui::wrapped(line.text, line.failed ? theme().danger : theme().text);
}

}  // namespace rebake
