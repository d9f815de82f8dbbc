#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Puts nodes into a new group; they stay where they are in the world.
struct Group {
  static constexpr const char* op = "group";
  std::vector<NodeRef> nodes;
  std::string as;
};
template <>
const EditType& edit_type<Group>();

Scene apply(const Scene& scene, const Group& edit);

}  // namespace rebake
