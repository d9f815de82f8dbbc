#include "editor/edits/nodes/background.h"

#include "editor/edits/describe_edit.h"

namespace rebake {

Scene apply(const Scene& scene, const Background& edit) {
  if ((edit.color.array() < 0).any() || (edit.color.array() > 1).any())
    throw FieldError("color", "must lie between 0 and 1");
  Scene result = scene;
  result.background = edit.color;
  return result;
}

REBAKE_DESCRIBE_EDIT(
    Background, "Sets the background colour.", (auto& edit, auto& visit) {
      visit("color", edit.color, Need::required, "red, green and blue as displayed", Unit::share);
    })

}  // namespace rebake
