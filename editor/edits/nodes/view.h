#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Stores a camera as a named view; replaces a view of the same name.
struct StoreView {
  static constexpr const char* op = "view";
  std::string name;
  Camera camera;
};
template <>
const EditType& edit_type<StoreView>();

Scene apply(const Scene& scene, const StoreView& edit);
/// Title of a step: see EditType::title.
std::string whole_title(const StoreView& edit);

}  // namespace rebake
