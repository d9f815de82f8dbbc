#pragma once

#include "editor/edits/deform/deforming_axis.h"

namespace rebake {

/// Bends triangles so that the axis becomes a circular arc of the same length (ClosedForm). Parts beyond the limits
/// follow rigidly or stay.
struct Bend {
  static constexpr const char* op = "bend";
  static constexpr bool deforms = true;
  static constexpr AdjustableField adjustable[] = {{"degrees", "Angle", AdjustableField::Kind::degrees},
                                                   {"from", "Start", AdjustableField::Kind::length},
                                                   {"to", "End", AdjustableField::Kind::length},
                                                   {"falloff", "Falloff", AdjustableField::Kind::length}};
  DeformTarget target;
  DeformAxis axis;
  double degrees = 0;       ///< angle between both limits
  Vec3 direction{1, 0, 0};  ///< bends towards it; only its part orthogonal to the axis counts
};
template <>
const EditType& edit_type<Bend>();

Outcome apply(const Scene& scene, const Bend& edit);
/// The past tense for titles of steps: see EditType::done.
std::string done_words(const Bend& edit);

}  // namespace rebake
