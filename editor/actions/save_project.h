#pragma once

#include "editor/actions/action.h"
#include "editor/actions/session.h"
#include "editor/fields/values.h"

namespace rebake {

/// Writes a project file: the sources, by relative path and content hash, and all edits.
struct SaveProjectAction {
  static constexpr const char* op = "save_project";
  std::string out;  ///< file, NAME.rebake
};
template <>
const ActionType& action_type<SaveProjectAction>();

void run(Session& session, const SaveProjectAction& action);

}  // namespace rebake
