#pragma once

#include "editor/commands/action.h"
#include "editor/commands/session.h"
#include "editor/fields/values.h"

namespace rebake {

/// Writes the scene in a format of the table; in MobileNeRF's, as scene.json where one folder cannot hold it.
struct ExportAction {
  static constexpr const char* op = "export";
  std::string out;
  std::string format = "mobilenerf";
  std::optional<Layout> layout;
  std::vector<NodeRef> nodes;  ///< only these and what is inside them; empty: all
};
template <>
const ActionType& action_type<ExportAction>();

void run(Session& session, const ExportAction& action);

}  // namespace rebake
