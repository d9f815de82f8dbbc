#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Adds a copy of a node and its children after the node. Triangles and texels are shared, not copied.
struct Duplicate {
  static constexpr const char* op = "duplicate";
  static constexpr const char* done = "Copied";
  static constexpr bool makes_nodes = true;
  NodeRef node;
  std::string as;           ///< name of the copy; empty: the node's name with a number
  Vec3 translate{0, 0, 0};  ///< offset of the copy, in world space
};
template <>
const EditType& edit_type<Duplicate>();

Scene apply(const Scene& scene, const Duplicate& edit);

}  // namespace rebake
