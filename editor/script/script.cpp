#include "editor/script/script.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "editor/actions/session.h"
#include "editor/edits/support.h"
#include "editor/fields/codec.h"
#include "editor/fields/field_info.h"
#include "mesh_ops/base/files.h"

namespace rebake {

using nlohmann::json;

namespace {

std::string substitute_variables(const std::string& text, const std::map<std::string, std::string>& variables) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t open = text.find('{', at), close = text.find('}', at);
    if (open == std::string::npos || close == std::string::npos || close < open) return out + text.substr(at);
    const std::string name = text.substr(open + 1, close - open - 1);
    const auto found = variables.find(name);
    if (found == variables.end())
      throw Error(fmt::format("the variable {{{0}}} has no value; set it with --var {0}=…", name));
    out += text.substr(at, open - at) + found->second;
    at = close + 1;
  }
  return out;
}

std::string reference_of(const char* op, const char* help, const std::vector<FieldInfo>& lines) {
  std::string out = fmt::format("### `{}`\n{}\n\n| field | value | default | meaning |\n|---|---|---|---|\n", op, help);
  for (const FieldInfo& line : lines)
    out += fmt::format("| `{}` | {} | {} | {} |\n", line.name, notation_of(line),
                       line.required                                    ? "required"
                       : line.initial.empty() || line.initial == "\"\"" ? "–"
                                                                        : "`" + line.initial + "`",
                       line.help);
  return out + '\n';
}

// Whether a field that takes nodes has a number.
bool names_nodes_by_number(const json& line) {
  const auto is_number = [](const json& value) {
    return value.is_number() || (value.is_array() && std::any_of(value.begin(), value.end(),
                                                                 [](const json& one) { return one.is_number(); }));
  };
  for (const EditType* type : edit_types()) {
    if (line.value("op", "") != type->op) continue;
    for (const FieldInfo& field : type->fields())
      if ((field.type.kind == FieldKind::node || field.type.kind == FieldKind::nodes) && line.contains(field.name) &&
          is_number(line.at(field.name)))
        return true;
  }
  return false;
}

// The projects that a script saves; lines with errors are left to run_script().
std::multiset<std::filesystem::path> saved_projects(const std::string& text,
                                                    const std::map<std::string, std::string>& variables) {
  std::multiset<std::filesystem::path> projects;
  std::istringstream lines{text};
  for (std::string line; std::getline(lines, line);) {
    const std::string_view command = command_text(line);
    if (command.find("save_project") == std::string_view::npos) continue;
    try {
      const json filled = with_variables(read_line(command), variables);
      if (filled.is_object() && filled.value("op", "") == "save_project")
        projects.insert(absolute_path(filled.value("out", "")));
    } catch (const std::exception&) {
      continue;
    }
  }
  return projects;
}

}  // namespace

ScriptCommand read_command(const json& line, const Scene& scene) {
  if (!line.is_object()) throw Error("must be a JSON object such as {\"op\": \"select\", …}");
  const auto op = line.find("op");
  if (op == line.end()) throw FieldError("op", "is missing");
  if (!op->is_string()) throw FieldError("op", "must be text");
  const auto& name = op->get_ref<const std::string&>();
  std::vector<std::string> known;
  for (const EditType* type : edit_types()) {
    if (name == type->op) return type->read(line, scene);
    known.emplace_back(type->op);
  }
  for (const ActionType* type : action_types()) {
    if (name == type->op) return type->read(line, scene);
    known.emplace_back(type->op);
  }
  const std::string near = nearest_word(name, known);
  throw FieldError(
      "op", near.empty() ? fmt::format("\"{}\" is not an edit or action; known are {}", name, fmt::join(known, ", "))
                         : fmt::format("\"{}\" is not an edit or action; did you mean \"{}\"?", name, near));
}

json with_variables(json line, const std::map<std::string, std::string>& variables) {
  if (line.is_string()) return substitute_variables(line.get<std::string>(), variables);
  if (line.is_structured())
    for (json& value : line) value = with_variables(std::move(value), variables);
  return line;
}

std::string json_error_message(const std::exception& error) {
  const std::string what = error.what();
  const std::size_t end = what.find("] ");
  return end == std::string::npos ? what : what.substr(end + 2);
}

std::string syntax_error_in(std::string_view line, std::string_view command, std::size_t byte,
                            const std::exception& error) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  std::string_view before = line.substr(0, static_cast<std::size_t>(command.data() - line.data()) + byte);
  if (before.starts_with(byte_order_mark)) before.remove_prefix(byte_order_mark.size());
  // Bytes 10xxxxxx continue a character of UTF-8. Beyond the end of the line is one more column.
  const auto column = std::count_if(before.begin(), before.end(), [](char one) { return (one & 0xC0) != 0x80; }) +
                      (byte > command.size() ? 1 : 0);
  const std::string message = json_error_message(error);  // "parse error at line 1, column 20: syntax error …"
  const std::size_t end = message.find(": ");
  return fmt::format("not valid JSON at column {}: {}", column,
                     end == std::string::npos ? message : message.substr(end + 2));
}

std::string_view command_text(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t\r\xEF\xBB\xBF");
  if (first == std::string_view::npos || line[first] == '#' || line.substr(first).starts_with("//")) return {};
  return line.substr(first);
}

json read_line(std::string_view text) {
  // No command is nested deeper, and deep nesting could exhaust the stack.
  static constexpr int deepest = 32;
  return json::parse(text.begin(), text.end(), [](int depth, json::parse_event_t, json&) {
    if (depth > deepest) throw Error(fmt::format("is nested deeper than {} levels", deepest));
    return true;
  });
}

std::string with_line_feeds(std::string_view text) {
  std::string lines(text);
  for (std::size_t k = 0; k < lines.size(); ++k)
    if (lines[k] == '\r' && (k + 1 == lines.size() || lines[k + 1] != '\n')) lines[k] = '\n';
  return lines;
}

void run_script(Session& session, std::string_view text, const std::filesystem::path& name,
                const std::map<std::string, std::string>& variables) {
  std::istringstream lines{with_line_feeds(text)};
  session.projects_to_come = saved_projects(lines.str(), variables);
  std::size_t number = 0;
  bool warned = session.scene().roots.empty();  // numbers are those of the script's own nodes
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const std::string_view command_line = command_text(line);
    if (command_line.empty()) continue;
    const auto fail = [&](const std::string& what) {
      throw ScriptError(fmt::format("{}: line {}: {}", name.string(), number, what));
    };
    try {
      const json object = read_line(command_line);
      const json filled = with_variables(object, variables);
      session.document.protect_files_of(filled);
      check_boxes(filled);
      const ScriptCommand command = read_command(filled, session.scene());
      if (!warned && names_nodes_by_number(filled)) {
        warned = true;
        session.say(
            fmt::format("warning: {}: line {}: gives a node by its number; in this scene, which had nodes before, "
                        "it may be another one than the script was made for",
                        name.string(), number));
      }
      if (const Edit* edit = std::get_if<Edit>(&command))
        session.edit(*edit);
      else
        std::get<Action>(command)(session);
      if (session.after_line) session.after_line();
    } catch (const json::parse_error& error) {
      fail("is " + syntax_error_in(line, command_line, error.byte, error));
    } catch (const json::exception& error) {
      fail("is not valid JSON: " + json_error_message(error));
    } catch (const Cancelled&) {
      throw;
    } catch (const std::filesystem::filesystem_error& error) {
      fail(error.path1().string() + ": " + error.code().message());
    } catch (const Error& error) {
      fail(error.what());
    }
  }
}

std::string command_reference() {
  std::string out = "## Edits\n\n";
  for (const EditType* type : edit_types()) out += reference_of(type->op, type->help, type->fields());
  out += "## Actions\n\n";
  for (const ActionType* type : action_types()) out += reference_of(type->op, type->help, type->fields());
  return out;
}

}  // namespace rebake
