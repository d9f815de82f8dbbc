#pragma once

#include <numbers>

#include "editor/edits/deforming_axis.h"

namespace rebake {

struct Twist {
  static constexpr const char* op = "twist";
  static constexpr const char* help = "Twists triangles about an axis, more and more between the limits.";
  DeformTarget target;
  DeformAxis axis;
  double degrees = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    DeformTarget::fields(self.target, visit);
    visit("degrees", self.degrees, Need::required, "in all, from one limit to the other");
    DeformAxis::fields(self.axis, visit);
  }
};

inline Scene apply(const Scene& scene, const Twist& edit) {
  ClosedForm form;
  form.kind = ClosedForm::Kind::twist;
  form.radians = edit.degrees * std::numbers::pi / 180;
  return with_closed_form(scene, edit.target, edit.axis, form);
}

}  // namespace rebake
