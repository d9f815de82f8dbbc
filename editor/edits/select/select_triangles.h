#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Selects triangles of an object by number, counted from 0 over its texture sets in order.
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
