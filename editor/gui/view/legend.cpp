#include "editor/gui/view/legend.h"

#include <fmt/format.h>

#include <string>

#include "editor/gui/tools/tool.h"
#include "editor/gui/ui/style.h"

namespace rebake {

void draw_legend(const Desk& desk, ImDrawList& list, const ImVec2& origin) {
  std::string text;
  if (desk.view.cut > 0 && desk.view.inspect == Guides::Inspect::none) {
    draw_label(list, {origin.x + px(12), origin.y + px(12)},
               fmt::format("Cut {:.4g} before the eye: Alt + wheel moves it", desk.view.cut));
    return;
  }
  switch (desk.view.inspect) {
    case Guides::Inspect::none:
      return;
    case Guides::Inspect::wireframe:
      text = "Wireframe: every triangle, a colour for each texture set";
      break;
    case Guides::Inspect::opacity:
      text = "Opacity: grey shows, dark red is transparent";
      break;
    case Guides::Inspect::texture_sets:
      text = "Texture sets: a colour for each";
      break;
    case Guides::Inspect::channel:
      text = fmt::format("Feature channel {}{}: black is 0, white 255", desk.view.channel,
                         desk.view.channel == 0 ? " (opacity)" : "");
      break;
    case Guides::Inspect::overdraw:
      text = "Overdraw: the brighter, the more triangles behind each other";
      break;
  }
  draw_label(list, {origin.x + px(12), origin.y + px(12)}, text);
}

}  // namespace rebake
