#pragma once

#include <string>

#include "editor/fields/codec.h"

namespace rebake {

/// Description of one field of an edit or action, for help, forms and the Python module.
struct FieldInfo {
  std::string name;
  FieldType type;
  std::string initial;  ///< default value as JSON; empty: none
  std::string help;
  Unit unit = Unit::none;
  bool required = false;
};

/// An identifier as words: "select_like" → "Select like".
std::string words_of(const std::string& identifier);

/// Name of the unit, for users; empty for Unit::none.
const char* to_string(Unit unit);
/// Notation of the field's value with its unit: "number, in degrees".
std::string notation_of(const FieldInfo& field);

}  // namespace rebake
