#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Moves the selected triangles of a node into a new node after it.
struct Separate {
  static constexpr const char* op = "separate";
  static constexpr bool needs_selection = true;
  static constexpr bool makes_nodes = true;
  NodeRef node;
  std::string as;  ///< name of the new node; empty: the node's name with a number
};
template <>
const EditType& edit_type<Separate>();

Outcome apply(const Scene& scene, const Separate& edit);
/// See EditType::change_title.
std::string change_title(const Separate& edit, const SceneChange& change, const Separate* replaced);

}  // namespace rebake
