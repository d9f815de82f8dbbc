#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Removes a node and its children from the scene.
struct Remove {
  static constexpr const char* op = "remove";
  static constexpr const char* done = "Removed";
  NodeRef node;
};
template <>
const EditType& edit_type<Remove>();

Scene apply(const Scene& scene, const Remove& edit);

}  // namespace rebake
