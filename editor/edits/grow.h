#pragma once

#include "editor/edits/selecting.h"

namespace rebake {

struct Grow {
  static constexpr const char* op = "grow";
  static constexpr const char* help = "Adds the triangles that share a corner with the selection.";
  std::optional<NodeRef> node;
  int steps = 1;
  WeldingField welding;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::optional, "only of this node and those inside it; left out: of all that is visible");
    visit("steps", self.steps, Need::optional, "how often");
    WeldingField::fields(self.welding, visit);
  }
};

inline Scene apply(const Scene& scene, const Grow& edit) {
  return with_selection_stepped(scene, edit.node, edit.steps, edit.welding, grown);
}

}  // namespace rebake
