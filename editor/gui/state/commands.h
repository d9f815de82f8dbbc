#pragma once

#include <optional>
#include <string>

#include "editor/gui/platform/window.h"
#include "editor/gui/state/editor_context.h"

namespace rebake {

/// Names of keys for users, from keys separated by spaces: "Ctrl+Shift+Z, Ctrl+Y", "Numpad 1".
std::string key_names(const std::string& keys);

/// A command of the window, started by key, menu or command palette.
struct Command {
  const char* menu;  ///< title of its menu; empty: only in the command palette
  const char* title;
  const char* keys;          ///< alternative keys separated by spaces, e.g. "Ctrl+Shift+Z Ctrl+Y"; empty for none
  const char* blender_keys;  ///< the same in the keymap that follows Blender
  const char* help;          ///< tooltip: one sentence; may be empty
  bool (*enabled)(const EditorContext& editor);
  void (*run)(EditorContext& editor);
  bool (*checked)(const EditorContext& editor) = nullptr;  ///< state of a toggle; null for other commands
  bool repeats = false;                                    ///< runs repeatedly while its key is held
  bool needs_rest = false;  ///< works on picks or the selection: refused while a job runs that may change them

  /// Keys in the current keymap.
  const char* keys_of(const Settings& settings) const { return settings.blender_keys ? blender_keys : keys; }
  /// Name of the first key in the current keymap; empty for none.
  std::string key_of(const Settings& settings) const {
    const std::string all = keys_of(settings);
    return key_names(all.substr(0, all.find(' ')));
  }
};

/// All commands, in menu order.
const std::vector<Command>& command_table();

/// Runs a command if it is available, otherwise says why it is not.
void run_command(EditorContext& editor, const Command& command);

/// Parses a key with modifiers, e.g. "Ctrl+Shift+A", "[", "KP_1"; nothing if the text is not valid.
std::optional<KeyPress> parse_key(const std::string& text);

/// The command with this title. Throws std::invalid_argument if there is none.
const Command& command_named(const std::string& title);
/// First key of a command in the current keymap, for tooltips; empty for none.
std::string command_key(const std::string& title, const Settings& settings);

/// Stores the current camera as a view of the scene, under `name` or, if empty, the first free name "view N".
void store_view(ToolContext& editor, const std::string& name = "");

/// The command that a key starts in the current keymap; null for none.
const Command* command_for(const KeyPress& press, const Settings& settings);

}  // namespace rebake
