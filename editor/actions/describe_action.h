#pragma once

// Describes an action's fields to the framework. Included only by the action's own .cpp.

#include "editor/actions/action.h"
#include "editor/fields/described.h"

namespace rebake::described {

/// Builds the ActionType of the action struct T.
template <class T, class Describe>
ActionType action_of(const char* help, Describe) {
  ActionType type{};
  type.op = T::op;
  type.help = help;
  type.fields = fields_of<T, Describe>;
  type.read = [](const nlohmann::json& object, const Scene& scene) -> Action {
    return [action = read_action<T>(object, scene)](Session& session) { run(session, action); };
  };
  if constexpr (requires(const nlohmann::json& object) { T::input_files(object); }) type.input_files = T::input_files;
  return type;
}

template <class T, class Describe>
T read_described(const nlohmann::json& object, const Scene& scene, Describe) {
  return read_fields<T, Describe>(object, scene);
}

}  // namespace rebake::described

/// Defines action_type<Type>() and read_action<Type>(). Arguments: the struct, one sentence of help, and (auto& action,
/// auto& visit) {…} that visits the fields.
#define REBAKE_DESCRIBE_ACTION(Type, help, ...)                                      \
  template <>                                                                        \
  Type read_action<Type>(const nlohmann::json& object, const Scene& scene) {         \
    return described::read_described<Type>(object, scene, [] __VA_ARGS__);           \
  }                                                                                  \
  template <>                                                                        \
  const ActionType& action_type<Type>() {                                            \
    static const ActionType type = described::action_of<Type>(help, [] __VA_ARGS__); \
    return type;                                                                     \
  }
