#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Gives a stored view another name.
struct RenameView {
  static constexpr const char* op = "rename_view";
  std::string name;
  std::string to;
};
template <>
const EditType& edit_type<RenameView>();

Scene apply(const Scene& scene, const RenameView& edit);

}  // namespace rebake
