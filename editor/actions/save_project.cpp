#include "editor/actions/save_project.h"

#include "editor/actions/describe_action.h"

#include <filesystem>

namespace rebake {

void run(Session& session, const SaveProjectAction& action) {
  if (std::filesystem::path(action.out).extension() != ".rebake")
    throw FieldError("out", "must end in .rebake, the extension of projects");
  const std::vector<std::string> warnings = session.document.save(action.out, session.progress);
  session.outputs.push_back(action.out);
  session.say("saved " + action.out);
  for (const std::string& warning : warnings) session.say("warning: " + warning);
}

REBAKE_DESCRIBE_ACTION(
    SaveProjectAction, "Writes a project file: the sources, by relative path and content hash, and all edits.",
    (auto& action, auto& visit) {
      visit("out", action.out, Need::required, "file to write, NAME.rebake; a project with more edits is not replaced");
    })

}  // namespace rebake
