#pragma once

#include "editor/actions/action.h"
#include "editor/actions/session.h"
#include "editor/fields/values.h"

namespace rebake {

/// Writes a Rebake scene folder, which contains all nodes, also hidden ones.
struct SaveAction {
  static constexpr const char* op = "save";
  std::string out;  ///< folder
};
template <>
const ActionType& action_type<SaveAction>();

void run(Session& session, const SaveAction& action);

}  // namespace rebake
