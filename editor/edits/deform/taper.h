#pragma once

#include "editor/edits/deform/deforming_axis.h"

namespace rebake {

/// Makes triangles thinner or thicker across an axis, more and more between the limits.
struct Taper {
  static constexpr const char* op = "taper";
  DeformTarget target;
  DeformAxis axis;
  double factor = 1;
};
template <>
const EditType& edit_type<Taper>();

Outcome apply(const Scene& scene, const Taper& edit);

}  // namespace rebake
