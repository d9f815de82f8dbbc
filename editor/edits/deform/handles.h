#pragma once

#include "editor/edits/deform/deforming.h"

namespace rebake {

/// Deforms triangles as rigidly as possible: some points of a wrap around them are held or moved, the rest follows.
struct HandlesDeform {
  static constexpr const char* op = "handles";
  DeformTarget target;
  CageSource cage;
  CageMoves moves;
  CageMoves fixed;
  int iterations = 200;
};
template <>
const EditType& edit_type<HandlesDeform>();

Outcome apply(const Scene& scene, const HandlesDeform& edit, const Progress& progress = {});

}  // namespace rebake
