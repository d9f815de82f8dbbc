#pragma once

#include "editor/edits/support.h"

namespace rebake {

struct Rename {
  static constexpr const char* op = "rename";
  static constexpr const char* help = "Gives a node another name.";
  NodeRef node;
  std::string name;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::required, "node to rename");
    visit("name", self.name, Need::required, "new name, not in use yet");
  }
};

inline Scene apply(const Scene& scene, const Rename& edit) {
  const PlacedNode placed = editable(scene, edit.node.id);
  if (edit.name.empty()) throw FieldError("name", "is empty");
  const NodePtr other = find(scene, edit.name);
  if (other != nullptr && other->id != edit.node.id)
    throw FieldError("name", "\"" + edit.name + "\" is the name of another node already");
  return with_changed(scene, edit.node.id, [&](Node& node) { node.name = edit.name; });
}

}  // namespace rebake
