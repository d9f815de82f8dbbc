#include "editor/actions/save_project.h"

#include <filesystem>

namespace rebake {

void run(Session& session, const SaveProjectAction& action) {
  if (std::filesystem::path(action.out).extension() != ".rebake")
    throw FieldError("out", "must end in .rebake, by which projects are known");
  session.document.save(action.out);
  session.say("saved " + action.out);
}

}  // namespace rebake
