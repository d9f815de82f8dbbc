#pragma once

#include <fmt/format.h>

#include "editor/edits/support.h"
#include "mesh_ops/formats/files.h"
#include "mesh_ops/formats/formats.h"

namespace rebake {

struct Import {
  static constexpr const char* op = "import";
  static constexpr const char* help = "Reads a MobileNeRF folder or a Rebake scene into the scene.";
  std::string path;
  std::string as;
  Axes axes = Axes::y_up;
  std::string content;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("path", self.path, Need::required, "folder to read");
    visit("as", self.as, Need::optional, "name of the new node; empty: the folder's name");
    visit("axes", self.axes, Need::optional, "which way a MobileNeRF folder is oriented; scenes say so themselves");
    visit("content", self.content, Need::optional,
          "hash of the folder's files as projects and journals record it: anything else there is refused");
  }
};

inline Scene apply(const Scene& scene, const Import& edit, const Progress& progress = {}) {
  if (!edit.content.empty() && fmt::format("{:016x}", folder_hash(edit.path)) != edit.content)
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
  Scene result = with_added(scene, std::move(node), NodeId::none, scene.roots.size());
  for (const auto& [name, camera] : read.views) result.views.try_emplace(name, camera);
  return result;
}

}  // namespace rebake
