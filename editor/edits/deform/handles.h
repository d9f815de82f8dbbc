#pragma once

#include "editor/edits/deform/deforming.h"

namespace rebake {

/// As-rigid-as-possible deformation of a cage: some vertices are fixed or moved, the others follow; mean value
/// coordinates carry the triangles along.
struct HandlesDeform {
  static constexpr const char* op = "handles";
  static constexpr const char* done = "Deformed by handles:";
  static constexpr bool deforms = true;
  DeformTarget target;
  CageSource cage;
  CageMoves moves;       ///< handles: vertices with their motions
  CageMoves fixed;       ///< vertices that keep their positions
  int iterations = 200;  ///< maximum, 1 … 1000
};
template <>
const EditType& edit_type<HandlesDeform>();

Outcome apply(const Scene& scene, const HandlesDeform& edit, const Progress& progress = {});

}  // namespace rebake
