#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Sets the scene's background colour.
struct Background {
  static constexpr const char* op = "background";
  Vec3 color{1, 1, 1};  ///< display RGB, 0 … 1
};
template <>
const EditType& edit_type<Background>();

Scene apply(const Scene& scene, const Background& edit);

}  // namespace rebake
