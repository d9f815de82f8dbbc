#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Erodes the selection: removes triangles that share a vertex with unselected ones.
struct Shrink {
  static constexpr const char* op = "shrink";
  static constexpr bool selects = true;
  static constexpr bool needs_selection = true;
  static constexpr AdjustableField adjustable[] = {{"steps", "Steps", AdjustableField::Kind::number}};
  std::optional<NodeRef> node;  ///< nothing: all visible, unlocked objects
  int steps = 1;                ///< number of rings
  WeldingField welding;
};
template <>
const EditType& edit_type<Shrink>();

Scene apply(const Scene& scene, const Shrink& edit);

}  // namespace rebake
