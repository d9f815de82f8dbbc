#include "editor/gui/app/legend.h"

#include <fmt/format.h>

#include <string>

#include "editor/gui/tools/tool.h"
#include "editor/gui/ui/style.h"

namespace rebake {

void draw_legend(const ViewState& view, ImDrawList& list, const ImVec2& origin) {
  std::string text;
  if (view.cut > 0 && view.inspect == Guides::Inspect::none) {
    draw_label(list, {origin.x + px(12), origin.y + px(12)},
               fmt::format("Near clipping plane at {:.4g}. Alt + wheel moves it.", view.cut));
    return;
  }
  switch (view.inspect) {
    case Guides::Inspect::none:
      return;
    case Guides::Inspect::wireframe:
      text = "Wireframe: all triangles, one colour per texture set";
      break;
    case Guides::Inspect::opacity:
      text = "Opacity: grey is opaque, dark red is transparent";
      break;
    case Guides::Inspect::texture_sets:
      text = "Texture sets: one colour per set";
      break;
    case Guides::Inspect::channel:
      text = fmt::format("Feature channel {}{}: black is 0, white is 255", view.channel,
                         view.channel == 0 ? " (opacity)" : "");
      break;
    case Guides::Inspect::overdraw:
      text = "Overdraw: brighter where more triangles overlap";
      break;
  }
  draw_label(list, {origin.x + px(12), origin.y + px(12)}, text);
}

}  // namespace rebake
