#include "editor/actions/undo.h"

#include <fmt/format.h>

namespace rebake {

void run(Session& session, const UndoAction& action) {
  if (action.steps < 1 || static_cast<std::size_t>(action.steps) > session.document.history().undo_count())
    throw FieldError("steps", fmt::format("{} edits can be undone", session.document.history().undo_count()));
  for (int step = 0; step < action.steps; ++step) session.document.undo();
}

}  // namespace rebake
