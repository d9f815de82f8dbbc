#include "editor/actions/use_light_model.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "editor/actions/describe_action.h"
#include "editor/actions/light_model.h"
#include "mesh_ops/base/error.h"

namespace rebake {

std::vector<std::filesystem::path> UseLightModelAction::input_files(const nlohmann::json& object) {
  const auto model = object.find("model");
  if (model == object.end() || !model->is_string()) return {};
  return {model->get<std::string>()};
}

void run(Session& session, const UseLightModelAction& action) {
  const TransferModel model = read_light_model(action.model);
  const NodePtr node = use_light_model(model, session.scene(), action.model);
  for (const std::string& fact : facts_of(model)) session.say(fact);
  session.say(fmt::format("drags of \"{}\" now use the model", node->name));
}

REBAKE_DESCRIBE_ACTION(
    UseLightModelAction, "Makes drags of an object use a trained model of its light transfer.",
    (auto& action, auto& visit) { visit("model", action.model, Need::required, "file that train_light wrote"); })

}  // namespace rebake
