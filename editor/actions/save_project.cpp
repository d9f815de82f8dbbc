#include "editor/actions/save_project.h"

#include "editor/actions/describe_action.h"
#include "editor/document/replaced_work.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace rebake {

void run(Session& session, const SaveProjectAction& action) {
  if (std::filesystem::path(action.out).extension() != ".rebake")
    throw FieldError("out", "must end in .rebake, the extension of projects");
  refuse_replacing_more(action.out, session.document.history().undo_count());
  const std::vector<std::string> before = edits_in(action.out);
  for (const std::string& warning : session.document.save(action.out, session.progress))
    session.say("warning: " + warning);
  session.outputs.push_back(action.out);
  session.say("saved " + action.out);
  const std::vector<std::string> after = edits_in(action.out);
  const auto differs = std::mismatch(before.begin(), before.end(), after.begin(), after.end()).first;
  if (differs != before.end())
    session.say(fmt::format("note: it replaced a project with {} other edits", before.end() - differs));
}

REBAKE_DESCRIBE_ACTION(
    SaveProjectAction, "Writes a project file: the sources, by relative path and content hash, and all edits.",
    (auto& action, auto& visit) {
      visit("out", action.out, Need::required, "file to write, NAME.rebake; a project with more edits is not replaced");
    })

}  // namespace rebake
