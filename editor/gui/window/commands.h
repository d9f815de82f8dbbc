#pragma once

#include <optional>
#include <string>

#include "editor/gui/window/desk.h"
#include "editor/gui/window/window.h"

namespace rebake {

/// Something that a key, a menu or the palette does.
struct Command {
  const char* menu;  ///< in which it stands; empty: the palette only
  const char* title;
  const char* keys;          ///< alternatives, separated by spaces, e.g. "Ctrl+Shift+Z"; empty for none
  const char* blender_keys;  ///< in the keymap that follows Blender
  const char* help;          ///< a sentence; empty where the title says it all
  bool (*enabled)(const Desk& desk);
  void (*run)(Desk& desk);
  bool (*checked)(const Desk& desk) = nullptr;  ///< whether what it turns on and off is on; null for others
  bool repeats = false;                         ///< while its key is held

  const char* keys_of(const Desk& desk) const { return desk.settings.blender_keys ? blender_keys : keys; }
  /// The first of them.
  std::string key_of(const Desk& desk) const {
    const std::string all = keys_of(desk);
    return all.substr(0, all.find(' '));
  }
};

/// All of them, in the order of the menus.
const std::vector<Command>& command_table();

/// A key with its modifiers as people write it, e.g. "Ctrl+Shift+A", "[", "KP_1". Nothing when it is no such text.
std::optional<KeyPress> parse_key(const std::string& text);

/// The command of that title. It must be there.
const Command& command_named(const std::string& title);
/// Its first key, for tooltips; empty for none.
std::string command_key(const std::string& title, const Desk& desk);

/// Keeps the present camera with the scene: under that name, or under a new one.
void store_view(Desk& desk, const std::string& name = "");

/// The command that a key starts now, null for none.
const Command* command_for(const KeyPress& press, const Desk& desk);

}  // namespace rebake
