#pragma once

#include <string>

namespace rebake {

/// A file or folder that a dialog asks for.
enum class PathQuestion {
  none,
  open,
  save_project,
  save_scene,
  export_folder,
  screenshot,
  turntable,
  camera_path,
  save_script,
  run_script,
  light_picture
};

/// What the window asks people just now.
struct Asking {
  PathQuestion path = PathQuestion::none;
  std::string form;  ///< the edit whose form is open, empty for none
  bool palette = false, quitting = false, keys = false, context = false;
};

}  // namespace rebake
