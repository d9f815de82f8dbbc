#include "editor/actions/save.h"

#include <fmt/format.h>

#include "mesh_ops/formats/scene_folder.h"

namespace rebake {

void run(Session& session, const SaveAction& action) {
  session.check_not_a_source("out", action.out);
  for (const std::string& note : save_scene_folder(session.scene(), action.out, session.progress))
    session.say("note: " + note);
  session.say(fmt::format("saved {}", action.out));
}

}  // namespace rebake
