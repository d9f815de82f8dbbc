#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "mesh_ops/scene/scene.h"

namespace rebake {

class Session;
struct FieldLine;

/// A command that is carried out.
using Action = std::function<void(Session&)>;

/// A kind of action: a line of the one table (table.cpp). Actions write files or walk through history, and are never
/// part of it. Each is a struct of its own, described in its own file by REBAKE_DESCRIBE_ACTION (describe.h).
struct ActionType {
  const char* op;    ///< its name in scripts
  const char* help;  ///< one sentence
  std::vector<FieldLine> (*fields)();
  Action (*read)(const nlohmann::json& object, const Scene& scene);
};

/// The type of an action's struct; each specialises this.
template <class T>
const ActionType& action_type();

/// All kinds of actions, in the order of help.
std::span<const ActionType* const> action_types();

}  // namespace rebake
