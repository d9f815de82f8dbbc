#pragma once

#include <string>
#include <vector>

#include "editor/gui/panels/field_inputs.h"

namespace rebake {

/// A button that opens a popup with inputs for fields.
class OptionsPopup {
 public:
  /// `help`: tooltip of the button. `problem`: see FieldInputs::draw().
  void draw(const DocumentEditor& editor, const char* help, const std::vector<FieldInfo>& fields, FieldInputs& inputs,
            const std::string& problem);
  /// Closes the popup in the next frame; returns false if it is not open.
  bool close();
  /// Tells that the dialog around it is closed.
  void leave() { open_ = false; }

 private:
  bool open_ = false, closes_ = false;
};

}  // namespace rebake
