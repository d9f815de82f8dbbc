#pragma once

#include <optional>

#include "editor/actions/action.h"
#include "editor/actions/session.h"
#include "editor/fields/values.h"

namespace rebake {

/// Makes drags of an object use rotated transfer again instead of a trained model.
struct ForgetLightModelAction {
  static constexpr const char* op = "forget_light_model";
  std::optional<NodeRef> node;  ///< nothing: the only object
};
template <>
const ActionType& action_type<ForgetLightModelAction>();
template <>
ForgetLightModelAction read_action<ForgetLightModelAction>(const nlohmann::json& object, const Scene& scene);

void run(Session& session, const ForgetLightModelAction& action);

}  // namespace rebake
