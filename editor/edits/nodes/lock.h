#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Protects a node and its children from edits.
struct Lock {
  static constexpr const char* op = "lock";
  static constexpr const char* done = "Locked";
  NodeRef node;
};
template <>
const EditType& edit_type<Lock>();

Scene apply(const Scene& scene, const Lock& edit);

}  // namespace rebake
