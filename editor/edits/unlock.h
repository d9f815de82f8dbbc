#pragma once

#include "editor/edits/support.h"

namespace rebake {

struct Unlock {
  static constexpr const char* op = "unlock";
  static constexpr const char* help = "Allows edits again.";
  NodeRef node;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::required, "node");
  }
};

inline Scene apply(const Scene& scene, const Unlock& edit) {
  present(scene, edit.node.id);
  return with_changed(scene, edit.node.id, [](Node& node) { node.locked = false; });
}

}  // namespace rebake
