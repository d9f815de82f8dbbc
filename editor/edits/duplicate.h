#pragma once

#include "editor/edits/support.h"

namespace rebake {

struct Duplicate {
  static constexpr const char* op = "duplicate";
  static constexpr const char* help =
      "Adds a copy of a node and its children after it; triangles and texels stay shared.";
  NodeRef node;
  std::string as;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::required, "node to copy");
    visit("as", self.as, Need::optional, "name of the copy; empty: the node's with a number");
  }
};

inline Scene apply(const Scene& scene, const Duplicate& edit) {
  const PlacedNode placed = present(scene, edit.node.id);
  Node copy = without_ids(*placed.node);
  if (!edit.as.empty()) {
    if (find(scene, edit.as) != nullptr)
      throw FieldError("as", "\"" + edit.as + "\" is the name of another node already");
    copy.name = edit.as;
  }
  const auto [parent, index] = place_of(scene, edit.node.id);
  return with_added(scene, std::move(copy), parent, index + 1);
}

}  // namespace rebake
