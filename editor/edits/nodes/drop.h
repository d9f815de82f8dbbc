#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Lets a node fall along the world's −y until it stands on what is visible below, or on the ground.
struct Drop {
  static constexpr const char* op = "drop";
  NodeRef node;
  double ground = 0;
};
template <>
const EditType& edit_type<Drop>();

Outcome apply(const Scene& scene, const Drop& edit);

}  // namespace rebake
