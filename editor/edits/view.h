#pragma once

#include "editor/edits/support.h"

namespace rebake {

struct StoreView {
  static constexpr const char* op = "view";
  static constexpr const char* help = "Stores a camera under a name.";
  std::string name;
  Camera camera;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("name", self.name, Need::required, "name of the view");
    visit("camera", self.camera, Need::required, "the camera; what is left out has its usual value");
  }
};

inline Scene apply(const Scene& scene, const StoreView& edit) {
  if (edit.name.empty()) throw FieldError("name", "is empty");
  Scene result = scene;
  result.views[edit.name] = edit.camera;
  return result;
}

}  // namespace rebake
