#pragma once

#include "editor/edits/deform/deforming_axis.h"

namespace rebake {

/// Stretches triangles along an axis between two limits; triangles above the upper limit move rigidly; those below the
/// lower limit stay.
struct Stretch {
  static constexpr const char* op = "stretch";
  static constexpr bool deforms = true;
  static constexpr AdjustableField adjustable[] = {{"factor", "Factor", AdjustableField::Kind::factor},
                                                   {"from", "Start", AdjustableField::Kind::length},
                                                   {"to", "End", AdjustableField::Kind::length},
                                                   {"falloff", "Falloff", AdjustableField::Kind::length}};
  DeformTarget target;
  DeformAxis axis;
  double factor = 1;  ///< new length between the limits, divided by the current length
};
template <>
const EditType& edit_type<Stretch>();

Outcome apply(const Scene& scene, const Stretch& edit);
/// The past tense for titles of steps: see EditType::done.
std::string done_words(const Stretch& edit);

}  // namespace rebake
