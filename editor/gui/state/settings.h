#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rebake {

/// Colour theme; `system` follows the desktop.
enum class ColorTheme { dark, light, system };
/// Tab of the bottom panel.
enum class BottomTab { history, views, light, script, cost, log };

/// User settings, stored as JSON in the configuration folder.
struct Settings {
  ColorTheme looks = ColorTheme::dark;
  double text_scale = 1;          ///< 0.6 … 3, multiplied by the monitor's scale
  bool scene_background = false;  ///< the viewport shows the scene's background, not the theme's
  bool adjust_open = true;        ///< the panel with the fields of the last step is open
  bool bottom_open = false;
  BottomTab bottom_tab = BottomTab::history;
  bool outline_open = true, properties_open = true;
  double outline_share = 0.5;  ///< share of the side bar's height, 0.15 … 0.85
  bool blender_keys = false;   ///< uses the keymap that follows Blender
  bool grid = true;
  double brush_radius = 20;                      ///< pixels, 1 … 500
  double likeness = 0.1;                         ///< colour tolerance of the flood tool, 0 … 1
  bool flood_everywhere = false;                 ///< the flood tool also selects unconnected triangles
  double side_width = 320;                       ///< logical pixels
  double bottom_height = 240;                    ///< logical pixels
  int window_width = 1280, window_height = 800;  ///< logical pixels
  std::string opened_from, written_to;           ///< last folders of the dialogs for reading and for writing
  std::vector<std::string> recent;               ///< up to 12 paths of opened or saved scenes, newest first

  /// Moves or adds a path to the front of `recent`.
  void remember(const std::string& path);
  bool operator==(const Settings&) const = default;
};

/// $XDG_CONFIG_HOME/rebake, by default ~/.config/rebake.
std::filesystem::path config_folder();
/// Folder for files that can be generated again: $XDG_CACHE_HOME/rebake, by default ~/.cache/rebake.
std::filesystem::path cache_folder();
/// Folder of the journals: $XDG_STATE_HOME/rebake/journals, by default ~/.local/state/rebake/journals.
std::filesystem::path journal_folder();

/// Reads settings; numbers out of range are clamped. If the file is missing or invalid, returns the defaults; `problem`
/// is set to a message if it is invalid.
Settings read_settings(const std::filesystem::path& file, std::string& problem);
/// Writes the settings that differ from `known` atomically, and those that the file lacks: what people or newer builds
/// wrote there meanwhile stays. A file that cannot be read is renamed first. Throws FileError.
void write_settings(const Settings& settings, const Settings& known, const std::filesystem::path& file);

}  // namespace rebake
