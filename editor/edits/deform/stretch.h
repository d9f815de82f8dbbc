#pragma once

#include "editor/edits/deform/deforming_axis.h"

namespace rebake {

/// Stretches triangles along an axis between two limits; parts beyond move rigidly or stay.
struct Stretch {
  static constexpr const char* op = "stretch";
  DeformTarget target;
  DeformAxis axis;
  double factor = 1;  ///< new length between the limits, relative to the present one
};
template <>
const EditType& edit_type<Stretch>();

Outcome apply(const Scene& scene, const Stretch& edit);

}  // namespace rebake
