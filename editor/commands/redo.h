#pragma once

#include "editor/commands/action.h"
#include "editor/commands/session.h"
#include "editor/fields/values.h"

namespace rebake {

/// Redoes undone edits.
struct RedoAction {
  static constexpr const char* op = "redo";
  int steps = 1;  ///< number of edits
};
template <>
const ActionType& action_type<RedoAction>();

void run(Session& session, const RedoAction& action);

}  // namespace rebake
