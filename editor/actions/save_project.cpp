#include "editor/actions/save_project.h"

#include "editor/actions/describe_action.h"

#include <fmt/format.h>

#include <filesystem>

#include "editor/document/replaced_work.h"
#include "mesh_ops/base/files.h"

namespace rebake {

void run(Session& session, const SaveProjectAction& action) {
  if (std::filesystem::path(action.out).extension() != ".rebake")
    throw FieldError("out", "must end in .rebake, the extension of projects");
  if (const auto known = session.projects_to_come.find(absolute_path(action.out));
      known != session.projects_to_come.end())
    session.projects_to_come.erase(known);
  // A script that saves to one project several times finds, in its second run, the last state of the first.
  if (session.projects_to_come.contains(absolute_path(action.out)) &&
      edits_in(action.out).size() > session.document.history().undo_count()) {
    session.say(fmt::format("note: {} has more edits already; a later line of this script saves it", action.out));
    return;
  }
  const SavedProject saved = session.document.save(action.out, session.progress);
  session.outputs.push_back(action.out);
  session.say("saved " + action.out);
  for (const std::string& warning : saved.warnings) session.say("warning: " + warning);
}

REBAKE_DESCRIBE_ACTION(
    SaveProjectAction, "Writes a project file: the sources, by relative path and content hash, and all edits.",
    (auto& action, auto& visit) {
      visit("out", action.out, Need::required, "file to write, NAME.rebake; a project with more edits is not replaced");
    })

}  // namespace rebake
