#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Moves a node within the outline, to another place or group; it stays where it is in the world.
struct Reorder {
  static constexpr const char* op = "reorder";
  NodeRef node;
  int index;
  std::optional<NodeRef> parent;
  bool top = false;
};
template <>
const EditType& edit_type<Reorder>();

Scene apply(const Scene& scene, const Reorder& edit);

}  // namespace rebake
