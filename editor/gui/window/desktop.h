#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/gui/window/child_process.h"

namespace rebake {

/// Whether the desktop wants dark windows: what its portal says (org.freedesktop.appearance), else GTK_THEME; dark
/// where nobody says anything. Asks another program, for at most half a second.
bool desktop_is_dark();

/// The desktop's own file dialog, in a process beside this one: zenity's or kdialog's, whichever is installed.
class DesktopFileDialog {
 public:
  enum class Kind { open_folders, open_file, save_file, save_folder };
  static bool there();

  /// `ending` of the files that are shown, e.g. ".rebake"; empty for all. Throws Error where it cannot be started.
  DesktopFileDialog(Kind kind, const std::string& title, const std::filesystem::path& start, const std::string& ending);
  /// Nothing while it is open; then the paths that were chosen, none when it was cancelled.
  std::optional<std::vector<std::string>> answer();

 private:
  std::unique_ptr<ChildProcess> process_;
};

}  // namespace rebake
