#pragma once

#include "editor/edits/deform/deforming_axis.h"

namespace rebake {

/// Bends triangles along an axis into an arc: the axis keeps its length, what lies beyond the limits follows.
struct Bend {
  static constexpr const char* op = "bend";
  DeformTarget target;
  DeformAxis axis;
  double degrees = 0;
  Vec3 direction{1, 0, 0};
};
template <>
const EditType& edit_type<Bend>();

Outcome apply(const Scene& scene, const Bend& edit);

}  // namespace rebake
