#pragma once

#include "editor/edits/deforming_axis.h"

namespace rebake {

struct Taper {
  static constexpr const char* op = "taper";
  static constexpr const char* help =
      "Makes triangles thinner or thicker across an axis, more and more between the limits.";
  DeformTarget target;
  DeformAxis axis;
  double factor = 1;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    DeformTarget::fields(self.target, visit);
    visit("factor", self.factor, Need::required, "size at the upper limit, as a share of now");
    DeformAxis::fields(self.axis, visit);
  }
};

inline Scene apply(const Scene& scene, const Taper& edit) {
  ClosedForm form;
  form.kind = ClosedForm::Kind::taper;
  form.factor = edit.factor;
  return with_closed_form(scene, edit.target, edit.axis, form);
}

}  // namespace rebake
