#pragma once

#include "editor/edits/deform/deforming_axis.h"

namespace rebake {

/// Stretches triangles along an axis between two limits; triangles above the upper limit move rigidly; those below the
/// lower limit stay.
struct Stretch {
  static constexpr const char* op = "stretch";
  DeformTarget target;
  DeformAxis axis;
  double factor = 1;  ///< new length between the limits, divided by the current length
};
template <>
const EditType& edit_type<Stretch>();

Outcome apply(const Scene& scene, const Stretch& edit);

}  // namespace rebake
