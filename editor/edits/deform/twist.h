#pragma once

#include "editor/edits/deform/deforming_axis.h"

namespace rebake {

/// Twists triangles about an axis, more and more between the limits.
struct Twist {
  static constexpr const char* op = "twist";
  DeformTarget target;
  DeformAxis axis;
  double degrees = 0;
};
template <>
const EditType& edit_type<Twist>();

Outcome apply(const Scene& scene, const Twist& edit);

}  // namespace rebake
