#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Selects triangles that the last deformation of their object folded or collapsed: det J ≤ 0 at a vertex.
struct SelectFolded {
  static constexpr const char* op = "select_folded";
  static constexpr bool selects = true;
  std::optional<NodeRef> node;  ///< nothing: all visible, unlocked objects
  SelectMode mode = SelectMode::set;
};
template <>
const EditType& edit_type<SelectFolded>();

Scene apply(const Scene& scene, const SelectFolded& edit);

}  // namespace rebake
