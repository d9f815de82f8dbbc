#pragma once

#include <string>

namespace rebake {

/// Purpose of the file dialog that is open.
enum class FileDialogPurpose {
  none,
  open,
  save_project,
  save_scene,
  export_folder,
  web_page,
  screenshot,
  turntable,
  camera_path,
  save_script,
  run_script,
  light_picture,  ///< environment map for the scene's light
  light_model,    ///< trained model of an object's light transfer
  photographs     ///< camera file or folder of a capture, for a training
};

/// Which dialogs and popups are open.
struct DialogState {
  FileDialogPurpose path = FileDialogPurpose::none;
  bool training = false;    ///< the form of the training is open
  std::string photographs;  ///< chosen by the file dialog for that form, until the form takes it
  std::string form;         ///< `op` of the edit whose form is open; empty for none
  /// Open popups: the command palette, the question about unsaved work on quitting, the sheet of keys. `context`: the
  /// context menu is to be opened in this frame.
  bool palette = false, quitting = false, keys = false, context = false;
};

}  // namespace rebake
