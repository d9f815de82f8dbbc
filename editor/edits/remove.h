#pragma once

#include "editor/edits/support.h"

namespace rebake {

struct Remove {
  static constexpr const char* op = "remove";
  static constexpr const char* help = "Takes a node and its children out of the scene.";
  NodeRef node;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::required, "node to remove");
  }
};

inline Scene apply(const Scene& scene, const Remove& edit) {
  editable_with_children(scene, edit.node.id);
  return without(scene, edit.node.id);
}

}  // namespace rebake
