#pragma once

#include <string>

#include "editor/fields/codec.h"

namespace rebake {

/// One field of an edit or action, as help, forms and the Python module show it.
struct FieldLine {
  std::string name;
  FieldType type;
  std::string initial;  ///< as JSON; empty for none
  std::string help;
  Unit unit = Unit::none;
  bool required = false;
};

/// In words; empty for none.
const char* to_string(Unit unit);
/// What a field takes, with its unit: "number, in degrees".
std::string words_of(const FieldLine& field);

}  // namespace rebake
