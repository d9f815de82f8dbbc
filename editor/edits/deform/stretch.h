#pragma once

#include "editor/edits/deform/deforming_axis.h"

namespace rebake {

/// Makes triangles longer or shorter along an axis, between the limits.
struct Stretch {
  static constexpr const char* op = "stretch";
  DeformTarget target;
  DeformAxis axis;
  double factor = 1;
};
template <>
const EditType& edit_type<Stretch>();

Outcome apply(const Scene& scene, const Stretch& edit);

}  // namespace rebake
