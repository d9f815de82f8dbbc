#include "editor/actions/export.h"

#include <fmt/format.h>

#include "mesh_ops/formats/export.h"

namespace rebake {

void run(Session& session, const ExportAction& action) {
  const ExportReport report = export_scene(session.scene(), action.out, {action.layout}, session.progress);
  session.exports.push_back(action.out);
  for (const std::string& note : report.notes) session.say("note: " + note);
  session.say(fmt::format("exported {}", action.out));
}

}  // namespace rebake
