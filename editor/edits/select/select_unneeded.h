#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Selects triangles that contribute to no picture. At least one criterion must be given; a triangle that meets any of
/// them is selected.
struct SelectUnneeded {
  static constexpr const char* op = "select_unneeded";
  static constexpr bool selects = true;
  std::optional<NodeRef> node;           ///< nothing: all visible, unlocked objects
  bool transparent = false;              ///< without opaque texels
  bool duplicates = false;               ///< same vertices and texels as a triangle drawn later
  int unseen = 0;                        ///< occluded from all of this many eyes on a sphere; 0: off
  double distance = 3;                   ///< radius of that sphere, in half diagonals of the object's box
  std::vector<std::string> unseen_from;  ///< occluded from all of these stored views
  SelectMode mode = SelectMode::set;
};
template <>
const EditType& edit_type<SelectUnneeded>();

Scene apply(const Scene& scene, const SelectUnneeded& edit);

}  // namespace rebake
