#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Selects triangles in a camera's picture: those seen through a pixel of the region, or with through all whose
/// centre falls into it.
struct SelectPicture {
  static constexpr const char* op = "select_picture";
  static constexpr bool selects = true;
  std::optional<NodeRef> node;
  PictureFields picture;
  bool through = false;
  SelectMode mode = SelectMode::set;
};
template <>
const EditType& edit_type<SelectPicture>();

Scene apply(const Scene& scene, const SelectPicture& edit);

}  // namespace rebake
