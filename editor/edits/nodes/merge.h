#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Makes objects of one decoder one node, in place of the first; parts that were separated before fit together
/// again as they were.
struct Merge {
  static constexpr const char* op = "merge";
  std::vector<NodeRef> nodes;
  std::string as;
};
template <>
const EditType& edit_type<Merge>();

Scene apply(const Scene& scene, const Merge& edit);

}  // namespace rebake
