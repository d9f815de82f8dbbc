#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Closes holes in a captured surface, for example where another object hid it.
struct FillHoles {
  static constexpr const char* op = "fill_holes";
  static constexpr const char* done = "Filled holes of";
  static constexpr bool needs_selection = true;
  std::optional<NodeRef> node;  ///< nothing: all visible, unlocked objects
  int longest = 300;            ///< edges of the border of a hole; longer borders are those of the surface itself
};
template <>
const EditType& edit_type<FillHoles>();

Outcome apply(const Scene& scene, const FillHoles& edit, const Progress& progress);

}  // namespace rebake
