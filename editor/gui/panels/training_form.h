#pragma once

#include <filesystem>
#include <string>

#include "editor/gui/panels/field_inputs.h"
#include "editor/gui/panels/options_popup.h"
#include "editor/gui/state/editor_context.h"

namespace rebake {

/// Form for a training from photographs; while it runs, its progress and buttons to pause, keep and continue it.
class TrainingForm {
 public:
  /// `right`: left border of the panels at the right, in window pixels.
  void draw(EditorContext& editor, float right);

 private:
  void draw_fields(EditorContext& editor);
  void draw_progress(EditorContext& editor);
  void suggest(const std::filesystem::path& photographs);
  void start(EditorContext& editor);
  void take_photographs(EditorContext& editor);
  FieldInputs inputs_;  ///< fields of TrainAction
  OptionsPopup options_;
  bool ran_ = false;  ///< a training ran in the last frame
  std::string problem_;
  std::string suggested_;  ///< the suggested output folder
  std::string replacing_;  ///< existing output folder for which the user was asked about replacing it
};

}  // namespace rebake
