#pragma once

// What an action's own .cpp includes to describe it.

#include "editor/commands/action.h"
#include "editor/fields/visitors.h"

namespace rebake::described {

/// `Describe` is a lambda that holds nothing: (action, visit) visits the action's fields.
template <class T, class Describe>
ActionType action_of(const char* help, Describe) {
  ActionType type{};
  type.op = T::op;
  type.help = help;
  type.fields = [] {
    std::vector<FieldLine> lines;
    FieldLister lister(lines);
    const T standard{};
    Describe{}(standard, lister);
    return lines;
  };
  type.read = [](const nlohmann::json& object, const Scene& scene) -> Action {
    T action;
    FieldReader reader(object, scene);
    Describe{}(action, reader);
    reader.finish();
    return [action](Session& session) { run(session, action); };
  };
  return type;
}

}  // namespace rebake::described

/// Defines action_type<Type>(): its help, then (auto& action, auto& visit) with its fields.
#define REBAKE_DESCRIBE_ACTION(Type, help, ...)                                      \
  template <>                                                                        \
  const ActionType& action_type<Type>() {                                            \
    static const ActionType type = described::action_of<Type>(help, [] __VA_ARGS__); \
    return type;                                                                     \
  }
