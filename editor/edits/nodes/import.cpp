#include "editor/edits/nodes/import.h"

#include "editor/edits/describe_edit.h"

#include <fmt/format.h>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

Outcome apply(const Scene& scene, const Import& edit, const Progress& progress) {
  if (edit.path.empty()) throw FieldError("path", "is empty");
  if (!edit.content.empty() && hash_text(folder_hash(edit.path)) != edit.content)
    throw EditError(edit.path + ": has changed since it was imported; restore the original files");
  const Scene read = read_any(edit.path, edit.axes, progress);
  if (read.roots.empty()) throw EditError(edit.path + ": contains no objects");
  Node node;
  if (read.roots.size() == 1) {
    node = without_ids(*read.roots.front());
  } else {
    node.name = folder_title(edit.path);
    for (const NodePtr& root : read.roots) node.children.push_back(std::make_shared<const Node>(without_ids(*root)));
  }
  if (!edit.as.empty()) {
    if (find(scene, edit.as) != nullptr)
      throw FieldError("as", "\"" + edit.as + "\" is already the name of another node; choose another name");
    node.name = edit.as;
  }
  Scene result = with_added(scene, std::move(node), NodeId::none, scene.roots.size());
  for (const auto& [name, camera] : read.views) result.views.try_emplace(name, camera);
  // The first import also sets the background, the ground and the light.
  if (scene.roots.empty()) {
    if (scene.background == Scene{}.background) result.background = read.background;
    if (!scene.light) result.light = read.light;
  }
  if (scene.roots.empty() && read.ground != Ground{})
    set_ground(result, read.ground);
  else if (const Box box = world_bounds(result); edit.ground && !box.isEmpty())
    set_ground(result, {Vec3::UnitY(), box.min().y()});
  Report report;
  for (const std::string& assumption : assumptions_of(read))
    report.lines.push_back(fmt::format("warning: {}: {}", edit.path, assumption));
  return {std::move(result), std::move(report)};
}

std::string whole_title(const Import& edit) { return "Imported " + folder_title(edit.path); }

REBAKE_DESCRIBE_EDIT(
    Import, "Reads a MobileNeRF folder or a Rebake scene into the scene.", (auto& edit, auto& visit) {
      visit("path", edit.path, Need::required, "folder to read");
      visit("as", edit.as, Need::optional, "name of the new node; empty: the folder's name");
      visit("axes", edit.axes, Need::optional, "orientation of a MobileNeRF folder; Rebake scenes contain theirs");
      visit("ground", edit.ground, Need::optional, "move the scene's ground to the lowest point of the scene");
      visit("content", edit.content, Need::optional,
            "expected hash of the folder's files, from projects and journals; other contents are refused");
    })

}  // namespace rebake
