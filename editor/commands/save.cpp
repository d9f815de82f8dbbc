#include "editor/commands/save.h"

#include "editor/commands/describe.h"

#include <fmt/format.h>

#include "mesh_ops/formats/scene_folder.h"

namespace rebake {

void run(Session& session, const SaveAction& action) {
  for (const std::string& note :
       save_scene_folder(session.scene(), action.out, session.document.sources(), session.progress))
    session.say("note: " + note);
  session.say(fmt::format("saved {}", action.out));
}

REBAKE_DESCRIBE_ACTION(
    SaveAction, "Writes a Rebake scene folder that keeps every node.",
    (auto& action, auto& visit) { visit("out", action.out, Need::required, "folder to write"); })

}  // namespace rebake
