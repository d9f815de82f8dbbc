#include "editor/actions/undo.h"

#include "editor/actions/describe_action.h"

#include <fmt/format.h>

namespace rebake {

void run(Session& session, const UndoAction& action) {
  if (action.steps < 1 || static_cast<std::size_t>(action.steps) > session.document.history().undo_count())
    throw FieldError("steps",
                     fmt::format("is out of range: {} edits can be undone", session.document.history().undo_count()));
  for (int step = 0; step < action.steps; ++step) session.document.undo(1, session.progress);
}

REBAKE_DESCRIBE_ACTION(
    UndoAction, "Undoes edits.",
    (auto& action, auto& visit) { visit("steps", action.steps, Need::optional, "number of edits"); })

}  // namespace rebake
