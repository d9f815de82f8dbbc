#include "editor/script/script_inputs.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "editor/document/sources.h"
#include "editor/script/script.h"

namespace rebake {

using nlohmann::json;

std::vector<ScriptInput> script_inputs(std::string_view text, const std::map<std::string, std::string>& variables) {
  std::vector<ScriptInput> inputs;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = command_text(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty()) continue;
    try {
      json object = read_line(line);
      if (!object.is_object()) continue;
      object = with_variables(std::move(object), variables);
      if (const json* source = source_field(object); source != nullptr && source->is_string())
        inputs.push_back({source->get<std::string>(), object.contains("content")});
      if (const auto mesh = object.find("mesh"); mesh != object.end() && mesh->is_string())
        inputs.push_back({mesh->get<std::string>(), false});
    } catch (const std::exception&) {
      // run_script() reports the error.
    }
  }
  return inputs;
}

}  // namespace rebake
