#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/base/child_process.h"

namespace rebake {

/// Whether the desktop prefers dark windows: by the environment variable GTK_THEME if set, else by the desktop portal
/// (org.freedesktop.appearance). Dark without an answer. Blocks for at most half a second.
bool desktop_is_dark();

/// The desktop's file dialog in a child process: zenity, else kdialog.
class DesktopFileDialog {
 public:
  enum class Kind { open_folders, open_file, save_file, save_folder };
  /// Whether zenity or kdialog is installed.
  static bool there();

  /// Opens the dialog. `start`: initial path; `ending`: extension of the files to list, e.g. ".rebake"; empty for all.
  /// Throws Error if the program cannot be started.
  DesktopFileDialog(Kind kind, const std::string& title, const std::filesystem::path& start, const std::string& ending);
  /// Nothing while the dialog is open; then the chosen paths, empty if it was cancelled. Does not block.
  std::optional<std::vector<std::string>> answer();

 private:
  std::unique_ptr<ChildProcess> process_;
};

}  // namespace rebake
