#include "editor/actions/render_action.h"

#include "editor/actions/describe_action.h"
#include "editor/actions/lit.h"
#include "editor/actions/views.h"
#include "editor/document/replaced_work.h"
#include "editor/edits/support.h"

#include <fmt/format.h>

#include "render/picture.h"

namespace rebake {

void run(Session& session, const RenderAction& action) {
  check_picture_path(action.out, session.document.sources());
  refuse_replacing_work(action.out);
  const Scene scene = with_only(session.scene(), action.nodes);
  const View view = resolve_view(scene, action.camera, action.view, action.width, action.height, action.samples);
  // Objects that are not drawn still cast shadows.
  const Lighting lighting = lit(session.scene(), session.progress);
  const Image picture = session.renderer().render(scene, view, {}, &lighting);
  write_picture(picture, action.out, session.document.sources());
  session.outputs.push_back(action.out);
  session.say(fmt::format("rendered {}", action.out));
  for (const LightDecision& decision : lighting.summary)
    session.say(fmt::format("light: {} {}: {}", decision.runs ? "runs" : "skipped", decision.name, decision.words()));
  if (const auto why = blank_reason(scene, view, picture)) session.say(*why);
}

REBAKE_DESCRIBE_ACTION(
    RenderAction, "Renders the scene to a picture file.", (auto& action, auto& visit) {
      visit("out", action.out, Need::required,
            "file to write: .png or .webp without loss, .jpg, or .exr (linear light)");
      visit("view", action.view, Need::optional,
            "name of a stored view; default: the camera, or one that frames the scene");
      visit("camera", action.camera, Need::optional, "the camera");
      visit("width", action.width, Need::optional, "size of the picture", Unit::pixels);
      visit("height", action.height, Need::optional, "size of the picture", Unit::pixels);
      visit("samples", action.samples, Need::optional, "samples per pixel: 1, 4 or 16");
      visit("nodes", action.nodes, Need::optional, "only these nodes and their children; default: all");
    })

}  // namespace rebake
