#include "editor/edits/nodes/import.h"

#include <algorithm>

#include "editor/edits/describe.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

namespace {

// A folder that is in the scene already is there once: on the GPU, for rays and for light. An edited object still has
// what it was made of.
void share(Node& node, const Scene& scene) {
  if (node.object) {
    for (const PlacedNode& placed : placed_nodes(scene)) {
      if (!placed.node->object) continue;
      std::vector<std::shared_ptr<const BakedObject>> there{placed.node->object};
      for (const BakedBody& body : placed.node->object->bodies) there.push_back(body.object);
      const auto same = std::find_if(there.begin(), there.end(),
                                     [&](const auto& object) { return same_reading(*object, *node.object); });
      if (same == there.end()) continue;
      node.object = *same;
      break;
    }
  }
  for (NodePtr& child : node.children) {
    Node shared = *child;
    share(shared, scene);
    child = std::make_shared<const Node>(std::move(shared));
  }
}

}  // namespace

Scene apply(const Scene& scene, const Import& edit, const Progress& progress) {
  if (edit.path.empty()) throw FieldError("path", "is empty");
  if (!edit.content.empty() && hash_text(folder_hash(edit.path)) != edit.content)
    throw EditError(edit.path + ": has changed since it was imported; put the files back as they were");
  const Scene read = read_any(edit.path, edit.axes, progress);
  if (read.roots.empty()) throw EditError(edit.path + ": holds no objects");
  Node node;
  if (read.roots.size() == 1) {
    node = without_ids(*read.roots.front());
  } else {
    node.name = folder_title(edit.path);
    for (const NodePtr& root : read.roots) node.children.push_back(std::make_shared<const Node>(without_ids(*root)));
  }
  if (!edit.as.empty()) {
    if (find(scene, edit.as) != nullptr)
      throw FieldError("as", "\"" + edit.as + "\" is the name of another node already");
    node.name = edit.as;
  }
  share(node, scene);
  Scene result = with_added(scene, std::move(node), NodeId::none, scene.roots.size());
  for (const auto& [name, camera] : read.views) result.views.try_emplace(name, camera);
  return result;
}

REBAKE_DESCRIBE_EDIT(
    Import, "Reads a MobileNeRF folder or a Rebake scene into the scene.", (auto& edit, auto& visit) {
      visit("path", edit.path, Need::required, "folder to read");
      visit("as", edit.as, Need::optional, "name of the new node; empty: the folder's name");
      visit("axes", edit.axes, Need::optional, "which way a MobileNeRF folder is oriented; scenes say so themselves");
      visit("content", edit.content, Need::optional,
            "hash of the folder's files as projects and journals record it: anything else there is refused");
    })

}  // namespace rebake
