#include "editor/edits/nodes/rename_view.h"

#include "editor/edits/describe_edit.h"
#include "editor/edits/stored_view.h"

namespace rebake {

Scene apply(const Scene& scene, const RenameView& edit) {
  const Camera camera = stored_view(scene, edit.name, "name");
  if (edit.to.empty()) throw FieldError("to", "is empty");
  if (edit.to != edit.name && scene.views.contains(edit.to))
    throw FieldError("to", "\"" + edit.to + "\" is already the name of another view; choose another name");
  Scene result = scene;
  result.views.erase(edit.name);
  result.views[edit.to] = camera;
  return result;
}

std::string whole_title(const RenameView& edit) {
  return "Renamed the view \"" + edit.name + "\" to \"" + edit.to + "\"";
}

REBAKE_DESCRIBE_EDIT(
    RenameView, "Renames a stored view.", (auto& edit, auto& visit) {
      visit("name", edit.name, Need::required, "name of the view");
      visit("to", edit.to, Need::required, "new, unique name");
    })

}  // namespace rebake
