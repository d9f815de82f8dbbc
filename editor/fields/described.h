#pragma once

// Structs whose fields a captureless lambda `Describe` (value, visit) describes: it calls `visit(name, member, need,
// help, unit)` for each field.

#include "editor/fields/visitors.h"

namespace rebake::described {

/// Names, types, defaults and help of the fields of T.
template <class T, class Describe>
std::vector<FieldInfo> fields_of() {
  std::vector<FieldInfo> lines;
  FieldLister lister(lines);
  const T standard{};
  Describe{}(standard, lister);
  return lines;
}

/// Reads a T from its JSON object; node names are looked up in `scene`. Throws FieldError.
template <class T, class Describe>
T read_fields(const nlohmann::json& object, const Scene& scene) {
  T value;
  FieldReader reader(object, scene);
  Describe{}(value, reader);
  reader.finish();
  return value;
}

}  // namespace rebake::described
