#pragma once

#include "editor/commands/action.h"
#include "editor/commands/session.h"
#include "editor/fields/values.h"

namespace rebake {

/// Draws the scene into a PNG.
struct RenderAction {
  static constexpr const char* op = "render";
  std::string out;
  std::string view;
  std::optional<Camera> camera;
  int width = 800;
  int height = 800;
  int samples = 4;
  std::vector<NodeRef> nodes;  ///< only these and what is inside them; empty: all
};
template <>
const ActionType& action_type<RenderAction>();

void run(Session& session, const RenderAction& action);

}  // namespace rebake
