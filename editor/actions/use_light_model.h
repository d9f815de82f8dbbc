#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "editor/actions/action.h"
#include "editor/actions/session.h"

namespace rebake {

/// Makes drags of an object use a trained model from a file. The scene stays as it is.
struct UseLightModelAction {
  static constexpr const char* op = "use_light_model";
  std::string model;  ///< file that train_light wrote

  static std::vector<std::filesystem::path> input_files(const nlohmann::json& object);
};
template <>
const ActionType& action_type<UseLightModelAction>();
template <>
UseLightModelAction read_action<UseLightModelAction>(const nlohmann::json& object, const Scene& scene);

/// Throws FileError for a file that is no model, and for a model of another object.
void run(Session& session, const UseLightModelAction& action);

}  // namespace rebake
