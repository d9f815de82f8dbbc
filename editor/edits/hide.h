#pragma once

#include "editor/edits/support.h"

namespace rebake {

struct Hide {
  static constexpr const char* op = "hide";
  static constexpr const char* help =
      "Hides a node and its children; they are neither drawn nor exported; save keeps them.";
  NodeRef node;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::required, "node");
  }
};

inline Scene apply(const Scene& scene, const Hide& edit) {
  present(scene, edit.node.id);
  return with_changed(scene, edit.node.id, [](Node& node) { node.visible = false; });
}

}  // namespace rebake
