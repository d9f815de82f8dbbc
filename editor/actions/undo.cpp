#include "editor/actions/undo.h"

#include <fmt/format.h>

#include "editor/actions/describe_action.h"
#include "mesh_ops/base/counted.h"

namespace rebake {

void run(Session& session, const UndoAction& action) {
  if (action.steps < 1 || static_cast<std::size_t>(action.steps) > session.document.history().undo_count())
    throw FieldError("steps", fmt::format("is out of range: {} be undone",
                                          counted(session.document.history().undo_count(), "edit can", "edits can")));
  for (int step = 0; step < action.steps; ++step) session.document.undo(1, session.progress);
}

REBAKE_DESCRIBE_ACTION(
    UndoAction, "Undoes edits.",
    (auto& action, auto& visit) { visit("steps", action.steps, Need::optional, "number of edits"); })

}  // namespace rebake
