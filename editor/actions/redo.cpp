#include "editor/actions/redo.h"

#include <fmt/format.h>

#include "editor/actions/describe_action.h"
#include "mesh_ops/base/counted.h"

namespace rebake {

void run(Session& session, const RedoAction& action) {
  if (action.steps < 1 || static_cast<std::size_t>(action.steps) > session.document.history().redo_count())
    throw FieldError("steps", fmt::format("is out of range: {} be redone",
                                          counted(session.document.history().redo_count(), "edit can", "edits can")));
  for (int step = 0; step < action.steps; ++step) session.document.redo(1, session.progress);
}

REBAKE_DESCRIBE_ACTION(
    RedoAction, "Redoes undone edits.",
    (auto& action, auto& visit) { visit("steps", action.steps, Need::optional, "number of edits"); })

}  // namespace rebake
