#pragma once

#include "editor/actions/action.h"
#include "editor/actions/session.h"
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
