#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <variant>

#include "editor/commands/action.h"
#include "editor/edits/edit.h"
#include "mesh_ops/base/error.h"

namespace rebake {

using ScriptCommand = std::variant<Edit, Action>;

/// A script error; says the file, the line and the field.
class ScriptError : public Error {
 public:
  using Error::Error;
};

/// Reads one command. Names of nodes are looked up in `scene`. Throws Error.
ScriptCommand read_command(const nlohmann::json& line, const Scene& scene);

/// Puts variables into all texts of a line: "{name}" becomes the value. Throws Error for one that has no value.
nlohmann::json with_variables(nlohmann::json line, const std::map<std::string, std::string>& variables);

/// What is wrong with a text that is no JSON, without the library's own name for it.
std::string said_by(const std::exception& error);

/// The JSON of a line of a script, without a byte order mark; empty for blank lines and comments.
std::string_view command_text(std::string_view line);

/// Parses one line of JSON, nested 32 levels at most. Throws Error, and nlohmann's exceptions for what is not JSON.
nlohmann::json read_line(std::string_view text);

/// Runs a script: one JSON object a line; blank lines and lines that begin with # or // are skipped. Throws
/// ScriptError; what was written before the line in error stays.
void run_script(Session& session, std::string_view text, const std::filesystem::path& name,
                const std::map<std::string, std::string>& variables);

/// Markdown: every command with its fields, types and defaults.
std::string command_reference();

}  // namespace rebake
