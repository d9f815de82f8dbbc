#include "editor/edits/deform/twist.h"

#include <fmt/format.h>

#include <numbers>

#include "editor/edits/describe_edit.h"

namespace rebake {

Outcome apply(const Scene& scene, const Twist& edit) {
  ClosedForm form;
  form.kind = ClosedForm::Kind::twist;
  form.radians = edit.degrees * std::numbers::pi / 180;
  return with_closed_form(scene, edit.target, edit.axis, form);
}

std::string done_words(const Twist& edit) { return fmt::format("Twisted by {:.4g}°:", edit.degrees); }

REBAKE_DESCRIBE_EDIT(
    Twist, "Twists triangles about an axis, with an angle that grows between the limits.", (auto& edit, auto& visit) {
      DeformTarget::fields(edit.target, visit);
      visit("degrees", edit.degrees, Need::required, "angle between both limits", Unit::degrees);
      DeformAxis::fields(edit.axis, visit);
    })

}  // namespace rebake
