#pragma once

#include "editor/actions/action.h"
#include "editor/actions/session.h"
#include "editor/fields/values.h"

namespace rebake {

/// Undoes edits.
struct UndoAction {
  static constexpr const char* op = "undo";
  int steps = 1;  ///< number of edits
};
template <>
const ActionType& action_type<UndoAction>();

void run(Session& session, const UndoAction& action);

}  // namespace rebake
