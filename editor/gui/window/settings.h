#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rebake {

enum class Looks { dark, light, system };
enum class BottomTab { history, views, light, script, cost, log };

/// What the editor remembers of a person, as JSON in the user's configuration folder.
struct Settings {
  Looks looks = Looks::dark;
  double text_scale = 1;  ///< beside what the monitor asks for
  bool scene_background = false;
  bool adjust_open = true;  ///< the fields of the last step, over the picture
  bool bottom_open = false;
  BottomTab bottom_tab = BottomTab::history;
  bool outline_open = true, properties_open = true;
  double outline_share = 0.5;  ///< of the side's height
  bool blender_keys = false;
  bool grid = true;
  double brush_radius = 20;  ///< pixels
  double likeness = 0.1;     ///< distance of colours that still count as alike, 0 … 1
  bool flood_everywhere = false;
  double side_width = 320;  ///< pixels on a plain screen
  double bottom_height = 240;
  int window_width = 1280, window_height = 800;
  std::string opened_from, written_to;  ///< folders of the last file dialogs
  std::vector<std::string> recent;      ///< newest first

  /// Puts a path first among the recent ones.
  void remember(const std::string& path);
  bool operator==(const Settings&) const = default;
};

/// $XDG_CONFIG_HOME/rebake, by default ~/.config/rebake.
std::filesystem::path config_folder();
/// What can be made anew: $XDG_CACHE_HOME/rebake, by default ~/.cache/rebake.
std::filesystem::path cache_folder();
/// Where journals of open editors lie: $XDG_STATE_HOME/rebake/journals, by default ~/.local/state/rebake/journals.
std::filesystem::path journal_folder();

/// Settings that cannot be read, or do not fit, are as at first; `problem` then says what is wrong with the file.
Settings read_settings(const std::filesystem::path& file, std::string& problem);
/// Throws FileError.
void write_settings(const Settings& settings, const std::filesystem::path& file);

}  // namespace rebake
