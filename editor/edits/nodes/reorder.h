#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Moves a node to another position or group in the tree; its world transform stays.
struct Reorder {
  static constexpr const char* op = "reorder";
  static constexpr const char* done = "Moved in the outline:";
  NodeRef node;
  int index;                      ///< position among the new siblings, from 0
  std::optional<NodeRef> parent;  ///< group to move into; nothing: its present group
  bool top = false;               ///< move to the roots
};
template <>
const EditType& edit_type<Reorder>();

Scene apply(const Scene& scene, const Reorder& edit);

}  // namespace rebake
