#pragma once

#include "editor/edits/support.h"

namespace rebake {

struct Merge {
  static constexpr const char* op = "merge";
  static constexpr const char* help =
      "Makes objects of one decoder one node, in place of the first; parts that were separated before fit together "
      "again "
      "as they were.";
  std::vector<NodeRef> nodes;
  std::string as;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("nodes", self.nodes, Need::required, "nodes to merge, in drawing order");
    visit("as", self.as, Need::optional, "name of the result; empty: the first one's");
  }
};

Scene apply(const Scene& scene, const Merge& edit);

}  // namespace rebake
