#include "editor/script/script_inputs.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "editor/document/document.h"
#include "editor/document/sources.h"
#include "editor/script/script.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

using nlohmann::json;

namespace {

// Appends the files that an action reads, and those of an edit that reads more than its source. Its node may not exist
// yet, and has no influence on them.
void add_input_files(const json& line, std::vector<ScriptInput>& inputs) {
  const std::string op = line.value("op", "");
  for (const ActionType* action : action_types())
    if (op == action->op && action->input_files != nullptr)
      for (std::filesystem::path& file : action->input_files(line)) inputs.push_back({std::move(file), false});
  for (std::filesystem::path& file : input_files_of(line)) inputs.push_back({std::move(file), false});
}

}  // namespace

std::vector<ScriptInput> script_inputs(std::string_view script, const std::map<std::string, std::string>& variables) {
  std::vector<ScriptInput> inputs;
  std::set<std::filesystem::path> written;
  const std::string lines = with_line_feeds(script);
  std::string_view text = lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = command_text(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty()) continue;
    try {
      json object = read_line(line);
      if (!object.is_object()) continue;
      object = with_variables(std::move(object), variables);
      const std::size_t before = inputs.size();
      if (const json* source = source_field(object); source != nullptr && source->is_string())
        inputs.push_back({source->get<std::string>(), object.contains("content")});
      add_input_files(object, inputs);
      for (std::size_t k = before; k < inputs.size(); ++k)
        inputs[k].written_before = written.contains(absolute_path(inputs[k].path));
      if (const auto out = object.find("out"); out != object.end() && out->is_string())
        written.insert(absolute_path(out->get<std::string>()));
    } catch (const std::exception&) {
      // run_script() reports the error.
    }
  }
  return inputs;
}

void protect_input_files(Document& document, std::string_view script,
                         const std::map<std::string, std::string>& variables) {
  for (const ScriptInput& input : script_inputs(script, variables)) {
    std::error_code error;
    // A file that the script writes itself and then reads; a second run finds that of the first.
    if (input.written_before && !input.content_known && std::filesystem::is_regular_file(input.path, error)) continue;
    if (scene_root(input.path) == input.path && std::filesystem::is_regular_file(input.path, error))
      document.protect_input(input.path, "a file that this script reads");
    else if (input.content_known)
      document.protect_input(input.path, "a scene that this script reads");
    else if (const std::filesystem::path folder = scene_root(input.path); std::filesystem::is_directory(folder, error))
      document.protect_contents(folder, "a scene that this script reads");
  }
}

}  // namespace rebake
