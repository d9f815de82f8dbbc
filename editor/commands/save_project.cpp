#include "editor/commands/save_project.h"

#include "editor/commands/describe.h"

#include <filesystem>

namespace rebake {

void run(Session& session, const SaveProjectAction& action) {
  if (std::filesystem::path(action.out).extension() != ".rebake")
    throw FieldError("out", "must end in .rebake, by which projects are known");
  for (const std::string& warning : session.document.save(action.out, session.progress))
    session.say("warning: " + warning);
  session.outputs.push_back(action.out);
  session.say("saved " + action.out);
}

REBAKE_DESCRIBE_ACTION(
    SaveProjectAction,
    "Writes a project: what was imported, by relative path and content, and the edits; open it like a folder.",
    (auto& action, auto& visit) { visit("out", action.out, Need::required, "file to write, NAME.rebake"); })

}  // namespace rebake
