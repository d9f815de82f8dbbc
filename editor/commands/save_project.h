#pragma once

#include "editor/commands/action.h"
#include "editor/commands/session.h"
#include "editor/fields/values.h"

namespace rebake {

/// Writes a project: what was imported, by relative path and content, and the edits; open it like a folder.
struct SaveProjectAction {
  static constexpr const char* op = "save_project";
  std::string out;
};
template <>
const ActionType& action_type<SaveProjectAction>();

void run(Session& session, const SaveProjectAction& action);

}  // namespace rebake
