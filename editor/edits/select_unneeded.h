#pragma once

#include "editor/edits/selecting.h"

namespace rebake {

struct SelectUnneeded {
  static constexpr const char* op = "select_unneeded";
  static constexpr const char* help =
      "Selects triangles that no picture needs, for cleaning: look at the count, then delete.";
  std::optional<NodeRef> node;
  bool transparent = false;
  bool duplicates = false;
  int unseen = 0;
  double distance = 3;
  std::vector<std::string> unseen_from;
  SelectMode mode = SelectMode::set;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::optional, "only of this node and those inside it; left out: of all that is visible");
    visit("transparent", self.transparent, Need::optional, "without an opaque texel");
    visit("duplicates", self.duplicates, Need::optional, "same corners and same texels as a triangle drawn later");
    visit("unseen", self.unseen, Need::optional,
          "not seen from this many eyes on a sphere around the object; other objects hide nothing");
    visit("distance", self.distance, Need::optional, "of the eyes, in half diagonals of the object's box");
    visit("unseen_from", self.unseen_from, Need::optional, "names of stored views: not seen from any of their eyes");
    visit("mode", self.mode, Need::optional, "how the result joins the present selection");
  }
};

Scene apply(const Scene& scene, const SelectUnneeded& edit);

}  // namespace rebake
