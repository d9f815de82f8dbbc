#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Takes away the selected triangles that share a corner with others.
struct Shrink {
  static constexpr const char* op = "shrink";
  static constexpr bool selects = true;
  std::optional<NodeRef> node;
  int steps = 1;
  WeldingField welding;
};
template <>
const EditType& edit_type<Shrink>();

Scene apply(const Scene& scene, const Shrink& edit);

}  // namespace rebake
