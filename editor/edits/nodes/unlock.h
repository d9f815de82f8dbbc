#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Unlocks a node, so that edits may change it again.
struct Unlock {
  static constexpr const char* op = "unlock";
  static constexpr const char* done = "Unlocked";
  NodeRef node;
};
template <>
const EditType& edit_type<Unlock>();

Scene apply(const Scene& scene, const Unlock& edit);

}  // namespace rebake
