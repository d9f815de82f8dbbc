#include "editor/edits/nodes/view.h"

#include "editor/edits/describe_edit.h"

namespace rebake {

Scene apply(const Scene& scene, const StoreView& edit) {
  if (edit.name.empty()) throw FieldError("name", "is empty");
  Scene result = scene;
  result.views[edit.name] = edit.camera;
  return result;
}

std::string whole_title(const StoreView& edit) { return "Stored the view \"" + edit.name + "\""; }

REBAKE_DESCRIBE_EDIT(
    StoreView, "Stores a camera as a named view.", (auto& edit, auto& visit) {
      visit("name", edit.name, Need::required, "name of the view");
      visit("camera", edit.camera, Need::required,
            "the camera; absent fields have defaults, and near and far planes are fitted to the visible objects");
    })

}  // namespace rebake
