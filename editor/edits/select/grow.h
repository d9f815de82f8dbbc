#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Adds the triangles that share a corner with the selection.
struct Grow {
  static constexpr const char* op = "grow";
  static constexpr bool selects = true;
  std::optional<NodeRef> node;
  int steps = 1;
  WeldingField welding;
};
template <>
const EditType& edit_type<Grow>();

Scene apply(const Scene& scene, const Grow& edit);

}  // namespace rebake
