#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Selects triangles that no picture needs, for cleaning: look at the count, then delete.
struct SelectUnneeded {
  static constexpr const char* op = "select_unneeded";
  static constexpr bool selects = true;
  std::optional<NodeRef> node;
  bool transparent = false;
  bool duplicates = false;
  int unseen = 0;
  double distance = 3;
  std::vector<std::string> unseen_from;
  SelectMode mode = SelectMode::set;
};
template <>
const EditType& edit_type<SelectUnneeded>();

Scene apply(const Scene& scene, const SelectUnneeded& edit);

}  // namespace rebake
