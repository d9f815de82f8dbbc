#pragma once

#include "editor/edits/support.h"

namespace rebake {

struct Show {
  static constexpr const char* op = "show";
  static constexpr const char* help = "Makes a node visible again.";
  NodeRef node;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::required, "node");
  }
};

inline Scene apply(const Scene& scene, const Show& edit) {
  present(scene, edit.node.id);
  return with_changed(scene, edit.node.id, [](Node& node) { node.visible = true; });
}

}  // namespace rebake
