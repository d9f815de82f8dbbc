#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Renames a stored view.
struct RenameView {
  static constexpr const char* op = "rename_view";
  std::string name;  ///< present name
  std::string to;    ///< new, unique name
};
template <>
const EditType& edit_type<RenameView>();

Scene apply(const Scene& scene, const RenameView& edit);
/// Title of a step: see EditType::title.
std::string whole_title(const RenameView& edit);

}  // namespace rebake
