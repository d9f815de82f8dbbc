#pragma once

#include "editor/edits/deform/deforming_axis.h"

namespace rebake {

/// Tapers triangles: scales them orthogonally to an axis, from 1 at the lower limit to `factor` at the upper one.
struct Taper {
  static constexpr const char* op = "taper";
  static constexpr bool deforms = true;
  static constexpr AdjustableField adjustable[] = {{"factor", "Factor", AdjustableField::Kind::factor},
                                                   {"from", "Start", AdjustableField::Kind::length},
                                                   {"to", "End", AdjustableField::Kind::length},
                                                   {"falloff", "Falloff", AdjustableField::Kind::length}};
  DeformTarget target;
  DeformAxis axis;
  double factor = 1;  ///< size at the upper limit, relative to the present one
};
template <>
const EditType& edit_type<Taper>();

Outcome apply(const Scene& scene, const Taper& edit);
/// The past tense for titles of steps: see EditType::done.
std::string done_words(const Taper& edit);

}  // namespace rebake
