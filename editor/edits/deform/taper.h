#pragma once

#include "editor/edits/deform/deforming_axis.h"

namespace rebake {

/// Tapers triangles: scales them orthogonally to an axis, from 1 at the lower limit to `factor` at the upper one.
struct Taper {
  static constexpr const char* op = "taper";
  DeformTarget target;
  DeformAxis axis;
  double factor = 1;  ///< size at the upper limit, relative to the present one
};
template <>
const EditType& edit_type<Taper>();

Outcome apply(const Scene& scene, const Taper& edit);

}  // namespace rebake
