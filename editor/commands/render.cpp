#include "editor/commands/render.h"

#include "editor/commands/describe.h"
#include "editor/commands/lit.h"
#include "editor/commands/views.h"
#include "editor/edits/support.h"

#include <fmt/format.h>

#include "render/picture.h"

namespace rebake {

void run(Session& session, const RenderAction& action) {
  check_png_path(action.out, session.document.sources());
  const Scene scene = with_only(session.scene(), action.nodes);
  const View view = chosen_view(scene, action.camera, action.view, action.width, action.height, action.samples);
  // Objects that are not drawn still cast shadows.
  const Lighting lighting = lit(session.scene(), session.progress);
  const Image picture = session.renderer().render(scene, view, {}, &lighting);
  write_png(picture, action.out, session.document.sources());
  session.outputs.push_back(action.out);
  session.say(fmt::format("rendered {}", action.out));
  for (const LightDecision& decision : lighting.summary)
    session.say(fmt::format("light: {} {}: {}", decision.runs ? "runs" : "left out", decision.name, decision.words()));
  if (const auto why = why_blank(scene, view, picture)) session.say(*why);
}

REBAKE_DESCRIBE_ACTION(
    RenderAction, "Draws the scene into a PNG.", (auto& action, auto& visit) {
      visit("out", action.out, Need::required, "PNG file to write");
      visit("view", action.view, Need::optional,
            "name of a stored view; left out: the camera, or one that frames the scene");
      visit("camera", action.camera, Need::optional, "the camera");
      visit("width", action.width, Need::optional, "of the picture", Unit::pixels);
      visit("height", action.height, Need::optional, "of the picture", Unit::pixels);
      visit("samples", action.samples, Need::optional, "a pixel: 1, 4 or 16");
      visit("nodes", action.nodes, Need::optional, "only these, with what is inside them; left out: all");
    })

}  // namespace rebake
