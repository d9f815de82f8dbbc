#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <variant>

#include "editor/actions/action.h"
#include "editor/edits/edit.h"
#include "mesh_ops/base/error.h"

namespace rebake {

/// One line of a script.
using ScriptCommand = std::variant<Edit, Action>;

/// Error in a script; the message contains the file, the line and, if known, the field.
class ScriptError : public Error {
 public:
  using Error::Error;
};

/// Parses one command from its JSON object; node names are looked up in `scene`. Throws Error.
ScriptCommand read_command(const nlohmann::json& line, const Scene& scene);

/// Replaces "{name}" by the variable's value in all strings of a JSON value. Throws Error for an unknown variable.
nlohmann::json with_variables(nlohmann::json line, const std::map<std::string, std::string>& variables);

/// Message of a JSON error, without the library's error code.
std::string json_error_message(const std::exception& error);
/// "not valid JSON at column 28: …" for a syntax error of the command in a line; columns are characters from 1.
/// `command`: the part of `line` that was parsed; `byte`: where in it, from 1, as nlohmann::json::parse_error tells.
std::string syntax_error_in(std::string_view line, std::string_view command, std::size_t byte,
                            const std::exception& error);

/// The text with line feeds in place of single carriage returns, which old editors write.
std::string with_line_feeds(std::string_view text);

/// The JSON text of a script line, without a byte order mark; empty for blank lines and comments.
std::string_view command_text(std::string_view line);

/// Parses one line of JSON. Throws Error if it is nested deeper than 32 levels, and nlohmann::json::exception if it is
/// not JSON.
nlohmann::json read_line(std::string_view text);

/// Runs a script: one JSON object per line. Blank lines and lines that begin with # or // are skipped. Throws
/// ScriptError at the first faulty line; edits and files of earlier lines stay. `name`: file name for messages.
void run_script(Session& session, std::string_view text, const std::filesystem::path& name,
                const std::map<std::string, std::string>& variables);

/// Reference of all edits and actions as Markdown: fields, types, units and defaults.
std::string command_reference();

}  // namespace rebake
