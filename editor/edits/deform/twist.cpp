#include "editor/edits/deform/twist.h"

#include <numbers>

#include "editor/edits/describe.h"

namespace rebake {

Outcome apply(const Scene& scene, const Twist& edit) {
  ClosedForm form;
  form.kind = ClosedForm::Kind::twist;
  form.radians = edit.degrees * std::numbers::pi / 180;
  return with_closed_form(scene, edit.target, edit.axis, form);
}

REBAKE_DESCRIBE_EDIT(
    Twist, "Twists triangles about an axis, more and more between the limits.", (auto& edit, auto& visit) {
      DeformTarget::fields(edit.target, visit);
      visit("degrees", edit.degrees, Need::required, "in all, from one limit to the other", Unit::degrees);
      DeformAxis::fields(edit.axis, visit);
    })

}  // namespace rebake
