#pragma once

#include "editor/edits/deform/deforming_axis.h"

namespace rebake {

/// Twists triangles about an axis, with an angle that grows from 0 at the lower limit to `degrees` at the upper one.
struct Twist {
  static constexpr const char* op = "twist";
  DeformTarget target;
  DeformAxis axis;
  double degrees = 0;  ///< angle at the upper limit
};
template <>
const EditType& edit_type<Twist>();

Outcome apply(const Scene& scene, const Twist& edit);

}  // namespace rebake
