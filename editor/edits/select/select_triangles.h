#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Selects triangles of an object by their numbers, set after set as in its files.
struct SelectTriangles {
  static constexpr const char* op = "select_triangles";
  static constexpr bool selects = true;
  NodeRef node;
  NumberRanges triangles;
  SelectMode mode = SelectMode::set;
};
template <>
const EditType& edit_type<SelectTriangles>();

Scene apply(const Scene& scene, const SelectTriangles& edit);

}  // namespace rebake
