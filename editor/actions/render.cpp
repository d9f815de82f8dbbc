#include "editor/actions/render.h"

#include <fmt/format.h>

#include "render/picture.h"

namespace rebake {

void run(Session& session, const RenderAction& action) {
  View view;
  view.width = action.width;
  view.height = action.height;
  view.samples = action.samples;
  if (!action.view.empty() && action.camera) throw FieldError("view", "contradicts camera");
  if (!action.view.empty()) {
    const auto found = session.scene().views.find(action.view);
    if (found == session.scene().views.end())
      throw FieldError("view", fmt::format("there is no view \"{}\"; store it with the view edit first", action.view));
    view.camera = found->second;
  } else {
    view.camera = action.camera
                      ? *action.camera
                      : framing_of(session.scene(), static_cast<double>(view.width) / std::max(view.height, 1));
  }
  write_png(session.renderer().render(session.scene(), view), action.out);
  session.say(fmt::format("rendered {}", action.out));
}

}  // namespace rebake
