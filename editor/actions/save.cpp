#include "editor/actions/save.h"

#include "editor/actions/describe_action.h"

#include <fmt/format.h>

#include <filesystem>

#include "mesh_ops/formats/formats.h"

namespace rebake {

void run(Session& session, const SaveAction& action) {
  if (action.out.empty()) throw FieldError("out", "is empty");
  std::error_code error;
  const bool replaces = std::filesystem::exists(action.out, error);
  const ExportReport report =
      format_named("rebake").write(session.scene(), action.out, {{}, session.document.sources()}, session.progress);
  session.wrote_scene(action.out, false);
  for (const std::string& note : report.notes) session.say("note: " + note);
  session.say(fmt::format("saved {}", action.out));
  if (replaces) session.say("note: the existing folder was replaced");
}

REBAKE_DESCRIBE_ACTION(
    SaveAction, "Writes a Rebake scene folder with all nodes.",
    (auto& action, auto& visit) { visit("out", action.out, Need::required, "folder to write"); })

}  // namespace rebake
