#pragma once

#include "editor/edits/deform/deforming_axis.h"

namespace rebake {

/// Twists triangles about an axis, with an angle that grows from 0 at the lower limit to `degrees` at the upper one.
struct Twist {
  static constexpr const char* op = "twist";
  static constexpr bool deforms = true;
  static constexpr AdjustableField adjustable[] = {{"degrees", "Angle", AdjustableField::Kind::degrees},
                                                   {"from", "Start", AdjustableField::Kind::length},
                                                   {"to", "End", AdjustableField::Kind::length},
                                                   {"falloff", "Falloff", AdjustableField::Kind::length}};
  DeformTarget target;
  DeformAxis axis;
  double degrees = 0;  ///< angle at the upper limit
};
template <>
const EditType& edit_type<Twist>();

Outcome apply(const Scene& scene, const Twist& edit);
/// The past tense for titles of steps: see EditType::done.
std::string done_words(const Twist& edit);

}  // namespace rebake
