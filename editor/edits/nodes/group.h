#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Moves nodes into a new group at the end of the roots; their world transforms stay.
struct Group {
  static constexpr const char* op = "group";
  static constexpr const char* done = "Grouped";
  static constexpr bool makes_nodes = true;
  std::vector<NodeRef> nodes;
  std::string as;  ///< name of the group; empty: "group"
};
template <>
const EditType& edit_type<Group>();

Scene apply(const Scene& scene, const Group& edit);

}  // namespace rebake
