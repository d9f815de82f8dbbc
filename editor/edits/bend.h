#pragma once

#include <numbers>

#include "editor/edits/deforming_axis.h"

namespace rebake {

struct Bend {
  static constexpr const char* op = "bend";
  static constexpr const char* help =
      "Bends triangles along an axis into an arc: the axis keeps its length, what lies beyond the limits follows.";
  DeformTarget target;
  DeformAxis axis;
  double degrees = 0;
  Vec3 direction{1, 0, 0};

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    DeformTarget::fields(self.target, visit);
    visit("degrees", self.degrees, Need::required, "in all, from one limit to the other");
    DeformAxis::fields(self.axis, visit);
    visit("direction", self.direction, Need::optional, "where the far end goes; its part across the axis counts");
  }
};

inline Scene apply(const Scene& scene, const Bend& edit) {
  ClosedForm form;
  form.kind = ClosedForm::Kind::bend;
  form.radians = edit.degrees * std::numbers::pi / 180;
  form.direction = edit.direction;
  return with_closed_form(scene, edit.target, edit.axis, form);
}

}  // namespace rebake
