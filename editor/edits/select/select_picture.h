#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Selects triangles in a region of a camera's picture: those visible at the centre of a pixel of the region, or with
/// `through` all whose centre projects into it.
struct SelectPicture {
  static constexpr const char* op = "select_picture";
  static constexpr bool selects = true;
  std::optional<NodeRef> node;  ///< nothing: all visible, unlocked objects
  PictureFields picture;
  bool through = false;  ///< also occluded triangles
  SelectMode mode = SelectMode::set;
};
template <>
const EditType& edit_type<SelectPicture>();

Scene apply(const Scene& scene, const SelectPicture& edit);

}  // namespace rebake
