#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Hides a node and its children: they are neither drawn nor exported, but saved.
struct Hide {
  static constexpr const char* op = "hide";
  static constexpr const char* done = "Hid";
  NodeRef node;
};
template <>
const EditType& edit_type<Hide>();

Scene apply(const Scene& scene, const Hide& edit);

}  // namespace rebake
