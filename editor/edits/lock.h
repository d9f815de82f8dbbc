#pragma once

#include "editor/edits/support.h"

namespace rebake {

struct Lock {
  static constexpr const char* op = "lock";
  static constexpr const char* help = "Protects a node and its children from edits.";
  NodeRef node;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::required, "node");
  }
};

inline Scene apply(const Scene& scene, const Lock& edit) {
  present(scene, edit.node.id);
  return with_changed(scene, edit.node.id, [](Node& node) { node.locked = true; });
}

}  // namespace rebake
