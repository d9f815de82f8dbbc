#include "editor/actions/render_action.h"

#include "editor/actions/describe_action.h"
#include "editor/actions/lit.h"
#include "editor/actions/views.h"
#include "editor/document/replaced_work.h"
#include "editor/edits/support.h"

#include <fmt/format.h>

#include "mesh_ops/motion/scene_at.h"
#include "render/picture.h"

namespace rebake {

void run(Session& session, const RenderAction& action) {
  for (const std::filesystem::path& file : files_of(action.content, action.out)) {
    check_picture_path(file, session.document.sources());
    refuse_replacing_work(file);
    refuse_replacing_unnamed(file, action.out);
  }
  check(action.content, action.out, action.width, action.height);
  const Scene all = action.time ? scene_at(session.scene(), *action.time) : session.scene();
  const Scene scene = with_only(all, action.nodes);
  const View view = resolve_view(scene, action.camera, action.view, action.width, action.height, action.samples);
  // Objects that are not drawn still cast shadows.
  const Lighting lighting = lit(all, session.progress);
  Image picture;
  if (action.sheet) {
    if (!action.content.passes.empty() || action.content.panorama || action.content.transparent)
      throw FieldError("sheet", "cannot be combined with passes, panorama or transparent");
    picture = sheet_of_views(session.renderer(), scene, view, *action.sheet, &lighting, session.progress);
    write_rendered(picture, action.out, session.document.sources());
  } else {
    picture = render_to_file(session.renderer(), scene, view, {}, &lighting, action.content, action.out,
                             session.document.sources());
  }
  for (const std::filesystem::path& file : files_of(action.content, action.out)) {
    session.outputs.push_back(file.string());
    session.say(fmt::format("rendered {}", file.string()));
  }
  for (const LightDecision& decision : lighting.summary)
    session.say(fmt::format("light: {} {}: {}", decision.runs ? "runs" : "skipped", decision.name, decision.words()));
  if (action.content.passes.empty() && !action.sheet)
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
      PictureContent::fields(action.content, visit);
      visit("separate", action.content.separate, Need::optional,
            "with passes: a file for each, such as picture.depth.exr");
      visit("time", action.time, Need::optional, "seconds: the scene as its keyframes move it; default: as it stands");
      visit("sheet", action.sheet, Need::optional,
            "columns and rows of a contact sheet of all stored views, width and height of each picture");
      visit("nodes", action.nodes, Need::optional, "only these nodes and their children; default: all");
    })

}  // namespace rebake
