// Keys of commands: their names, how they are written in the table, and the command that a key starts.
#include <GLFW/glfw3.h>

#include <map>
#include <sstream>

#include "editor/gui/state/commands.h"

namespace rebake {

std::string key_names(const std::string& keys) {
  std::istringstream words(keys);
  std::string names;
  for (std::string key; words >> key;) {
    const auto rename = [&](const std::string& code, const std::string& name) {
      if (const std::size_t at = key.find(code); at != std::string::npos) key.replace(at, code.size(), name);
    };
    rename("KP_ADD", "Numpad +");
    rename("KP_SUBTRACT", "Numpad -");
    rename("KP_DECIMAL", "Numpad .");
    rename("KP_", "Numpad ");
    rename("Comma", ",");
    names += (names.empty() ? "" : ", ") + key;
  }
  return names;
}

std::optional<KeyPress> parse_key(const std::string& text) {
  static const std::map<std::string, int> named = {{"Delete", GLFW_KEY_DELETE}, {"Escape", GLFW_KEY_ESCAPE},
                                                   {"Enter", GLFW_KEY_ENTER},   {"Home", GLFW_KEY_HOME},
                                                   {"Comma", GLFW_KEY_COMMA},   {"KP_DECIMAL", GLFW_KEY_KP_DECIMAL},
                                                   {"KP_ADD", GLFW_KEY_KP_ADD}, {"KP_SUBTRACT", GLFW_KEY_KP_SUBTRACT},
                                                   {"Tab", GLFW_KEY_TAB},       {"End", GLFW_KEY_END},
                                                   {"Space", GLFW_KEY_SPACE}};
  KeyPress press;
  std::string rest = text;
  for (bool more = true; more;) {
    more = false;
    for (const auto& [name, flag] : {std::pair("Ctrl+", &KeyPress::control), std::pair("Shift+", &KeyPress::shift),
                                     std::pair("Alt+", &KeyPress::alt)})
      if (rest.starts_with(name) && !(press.*flag)) {
        press.*flag = true;
        rest = rest.substr(std::string(name).size());
        more = true;
      }
  }
  if (const auto found = named.find(rest); found != named.end()) {
    press.key = found->second;
  } else if (rest.size() == 1 && ((rest[0] >= 'A' && rest[0] <= 'Z') || (rest[0] >= '0' && rest[0] <= '9') ||
                                  rest[0] == '[' || rest[0] == ']')) {
    press.key = static_cast<unsigned char>(rest[0]);  // GLFW's key codes of these characters are ASCII
  } else if (rest.size() == 4 && rest.starts_with("KP_") && rest[3] >= '0' && rest[3] <= '9') {
    press.key = GLFW_KEY_KP_0 + (rest[3] - '0');
  } else if (rest.size() >= 2 && rest.size() <= 3 && rest[0] == 'F' &&
             rest.find_first_not_of("0123456789", 1) == std::string::npos) {
    const int number = std::stoi(rest.substr(1));
    if (number < 1 || number > 12) return std::nullopt;
    press.key = GLFW_KEY_F1 + number - 1;
  } else {
    return std::nullopt;
  }
  return press;
}

const Command* command_for(const KeyPress& press, const Settings& settings) {
  for (const Command& command : command_table()) {
    std::istringstream keys(command.keys_of(settings));
    for (std::string key; keys >> key;)
      if (parse_key(key) == press) return &command;
  }
  return nullptr;
}

}  // namespace rebake
