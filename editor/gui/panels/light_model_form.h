#pragma once

#include <string>

#include "editor/gui/panels/field_inputs.h"
#include "editor/gui/panels/options_popup.h"
#include "editor/gui/state/editor_context.h"

namespace rebake {

/// Buttons of the light panel that train, load and forget the model of light transfer for drags.
class LightModelForm {
 public:
  void draw(EditorContext& editor);

 private:
  void train(EditorContext& editor);
  void forget(EditorContext& editor);
  FieldInputs inputs_;  ///< fields of TrainLightAction
  OptionsPopup options_;
  std::string problem_;
};

/// Starts a job that makes drags use the model of a file.
void use_light_model_of(EditorContext& editor, const std::string& file);

}  // namespace rebake
