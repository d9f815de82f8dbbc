#pragma once

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
  /// Closes the popup with more options; returns false if it is not open.
  bool close_popup() { return options_.close(); }

 private:
  void draw_fields(EditorContext& editor);
  void draw_progress(EditorContext& editor);
  void take_photographs(EditorContext& editor);
  FieldInputs inputs_;  ///< fields of TrainAction
  OptionsPopup options_;
  std::string problem_;
};

}  // namespace rebake
