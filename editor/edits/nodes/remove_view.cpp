#include "editor/edits/nodes/remove_view.h"

#include "editor/edits/describe_edit.h"
#include "editor/edits/stored_view.h"

namespace rebake {

Scene apply(const Scene& scene, const RemoveView& edit) {
  stored_view(scene, edit.name, "name");
  Scene result = scene;
  result.views.erase(edit.name);
  return result;
}

std::string whole_title(const RemoveView& edit) { return "Removed the view \"" + edit.name + "\""; }

REBAKE_DESCRIBE_EDIT(
    RemoveView, "Removes a stored view.",
    (auto& edit, auto& visit) { visit("name", edit.name, Need::required, "name of the view"); })

}  // namespace rebake
