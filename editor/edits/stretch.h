#pragma once

#include "editor/edits/deforming_axis.h"

namespace rebake {

struct Stretch {
  static constexpr const char* op = "stretch";
  static constexpr const char* help = "Makes triangles longer or shorter along an axis, between the limits.";
  DeformTarget target;
  DeformAxis axis;
  double factor = 1;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    DeformTarget::fields(self.target, visit);
    visit("factor", self.factor, Need::required, "length between the limits, as a share of now");
    DeformAxis::fields(self.axis, visit);
  }
};

inline Scene apply(const Scene& scene, const Stretch& edit) {
  ClosedForm form;
  form.kind = ClosedForm::Kind::stretch;
  form.factor = edit.factor;
  return with_closed_form(scene, edit.target, edit.axis, form);
}

}  // namespace rebake
