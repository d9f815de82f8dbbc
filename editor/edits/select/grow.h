#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Dilates the selection by its one-ring: adds triangles that share a vertex with it.
struct Grow {
  static constexpr const char* op = "grow";
  static constexpr bool selects = true;
  static constexpr bool needs_selection = true;
  static constexpr AdjustableField adjustable[] = {{"steps", "Steps", AdjustableField::Kind::number}};
  std::optional<NodeRef> node;  ///< nothing: all visible, unlocked objects
  int steps = 1;                ///< number of rings
  WeldingField welding;
};
template <>
const EditType& edit_type<Grow>();

Scene apply(const Scene& scene, const Grow& edit);

}  // namespace rebake
