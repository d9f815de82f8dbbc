#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "editor/fields/field_info.h"
#include "editor/gui/state/document_editor.h"

namespace rebake {

/// Inputs for the fields of an edit or action, which fill in its JSON object.
class FieldInputs {
 public:
  /// Draws a labelled input per field. `problem`: an error message, drawn below the field that it names; may be empty.
  void draw(const DocumentEditor& editor, const std::vector<FieldInfo>& fields, const std::string& problem);
  void set(const std::string& field, const nlohmann::json& value);
  /// The fields that are set.
  const nlohmann::json& values() const { return values_; }

 private:
  nlohmann::json values_ = nlohmann::json::object();
  std::map<std::string, std::string> texts_;  ///< typed texts of fields with a text box, by field name
};

}  // namespace rebake
