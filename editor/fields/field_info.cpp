#include "editor/fields/field_info.h"

#include <fmt/format.h>
#include <cctype>

#include <algorithm>
#include <utility>

namespace rebake {

const char* to_string(Unit unit) {
  switch (unit) {
    case Unit::degrees:
      return "degrees";
    case Unit::length:
      return "scene units";
    case Unit::object_length:
      return "the object's units";
    case Unit::pixels:
      return "pixels";
    case Unit::share:
      return "share";
    case Unit::factor:
      return "factor";
    default:
      return "";
  }
}

std::string words_of(const std::string& identifier) {
  for (const auto& [name, spelt] : {std::pair("psnr", "PSNR"), {"bgr", "BGR"}})
    if (identifier == name) return spelt;
  std::string words = identifier;
  std::replace(words.begin(), words.end(), '_', ' ');
  if (!words.empty()) words[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
  return words;
}

std::string notation_of(const FieldInfo& field) {
  if (field.unit == Unit::none) return field.type.words;
  const bool bare = field.unit == Unit::share || field.unit == Unit::factor;  // numbers without a dimension
  return fmt::format("{}, {} {}", field.type.words, bare ? "as a" : "in", to_string(field.unit));
}

}  // namespace rebake
