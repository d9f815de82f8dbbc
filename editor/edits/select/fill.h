#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Fills holes of the selection: adds edge-connected components of unselected triangles that border it.
struct Fill {
  static constexpr const char* op = "fill";
  static constexpr bool selects = true;
  static constexpr bool needs_selection = true;
  std::optional<NodeRef> node;  ///< nothing: all visible, unlocked objects
  int at_most = 1000;           ///< largest component to add, in triangles
  WeldingField welding;
};
template <>
const EditType& edit_type<Fill>();

Scene apply(const Scene& scene, const Fill& edit);

}  // namespace rebake
