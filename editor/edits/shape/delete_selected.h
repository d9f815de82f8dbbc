#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Removes the selected triangles, and nodes that lose all their triangles and have no children.
struct DeleteSelected {
  static constexpr const char* op = "delete";
  static constexpr bool needs_selection = true;
  std::optional<NodeRef> node;  ///< nothing: all visible, unlocked objects
};
template <>
const EditType& edit_type<DeleteSelected>();

Outcome apply(const Scene& scene, const DeleteSelected& edit);
/// See EditType::change_title.
std::string change_title(const DeleteSelected& edit, const SceneChange& change, const DeleteSelected* replaced);

}  // namespace rebake
