#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Merges objects with equal decoders into one node, in place of the first. Merging separated parts restores the
/// original object.
struct Merge {
  static constexpr const char* op = "merge";
  static constexpr const char* done = "Merged";
  static constexpr bool makes_nodes = true;
  std::vector<NodeRef> nodes;  ///< two or more, in drawing order
  std::string as;              ///< name of the result; empty: that of the first node
};
template <>
const EditType& edit_type<Merge>();

Outcome apply(const Scene& scene, const Merge& edit);

}  // namespace rebake
