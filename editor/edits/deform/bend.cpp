#include "editor/edits/deform/bend.h"

#include <numbers>

#include "editor/edits/describe.h"

namespace rebake {

Outcome apply(const Scene& scene, const Bend& edit) {
  ClosedForm form;
  form.kind = ClosedForm::Kind::bend;
  form.radians = edit.degrees * std::numbers::pi / 180;
  form.direction = edit.direction;
  return with_closed_form(scene, edit.target, edit.axis, form);
}

REBAKE_DESCRIBE_EDIT(
    Bend, "Bends triangles along an axis into an arc: the axis keeps its length, what lies beyond the limits follows.",
    (auto& edit, auto& visit) {
      DeformTarget::fields(edit.target, visit);
      visit("degrees", edit.degrees, Need::required, "in all, from one limit to the other", Unit::degrees);
      DeformAxis::fields(edit.axis, visit);
      visit("direction", edit.direction, Need::optional, "where the far end goes; its part across the axis counts");
    })

}  // namespace rebake
