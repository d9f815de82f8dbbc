#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "mesh_ops/scene/scene.h"

namespace rebake {

class Session;
struct FieldInfo;

/// A parsed action, ready to run.
using Action = std::function<void(Session&)>;

/// Description of one kind of action; table.cpp lists all. Actions write files, or undo and redo edits, and are not
/// steps of history themselves. Each kind is a struct in its own file, described there by REBAKE_DESCRIBE_ACTION
/// (describe_action.h).
struct ActionType {
  const char* op;                      ///< name in scripts
  const char* help;                    ///< one sentence
  std::vector<FieldInfo> (*fields)();  ///< names, types, defaults and help
  /// Parses an action from its JSON object; node names are looked up in `scene`. Throws FieldError.
  Action (*read)(const nlohmann::json& object, const Scene& scene);
  /// Files and scenes that the action reads besides the scene, by a static function input_files() of the struct; null
  /// if it reads none. Throws FileError.
  std::vector<std::filesystem::path> (*input_files)(const nlohmann::json& object);
};

/// The ActionType of an action struct; specialised per action.
template <class T>
const ActionType& action_type();

/// Parses an action from its JSON object, as ActionType::read does; specialised per action. Throws FieldError.
template <class T>
T read_action(const nlohmann::json& object, const Scene& scene);

/// All kinds of actions, in help order.
std::span<const ActionType* const> action_types();

}  // namespace rebake
