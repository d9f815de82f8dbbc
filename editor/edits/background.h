#pragma once

#include "editor/edits/support.h"

namespace rebake {

struct Background {
  static constexpr const char* op = "background";
  static constexpr const char* help = "Sets the colour behind everything.";
  Vec3 color{1, 1, 1};

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("color", self.color, Need::required, "display red, green, blue from 0 to 1");
  }
};

inline Scene apply(const Scene& scene, const Background& edit) {
  if ((edit.color.array() < 0).any() || (edit.color.array() > 1).any())
    throw FieldError("color", "must lie between 0 and 1");
  Scene result = scene;
  result.background = edit.color;
  return result;
}

}  // namespace rebake
