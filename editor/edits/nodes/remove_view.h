#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Removes a stored view.
struct RemoveView {
  static constexpr const char* op = "remove_view";
  std::string name;
};
template <>
const EditType& edit_type<RemoveView>();

Scene apply(const Scene& scene, const RemoveView& edit);
/// Title of a step: see EditType::title.
std::string whole_title(const RemoveView& edit);

}  // namespace rebake
