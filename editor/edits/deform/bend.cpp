#include "editor/edits/deform/bend.h"

#include <fmt/format.h>

#include <numbers>

#include "editor/edits/describe_edit.h"

namespace rebake {

Outcome apply(const Scene& scene, const Bend& edit) {
  ClosedForm form;
  form.kind = ClosedForm::Kind::bend;
  form.radians = edit.degrees * std::numbers::pi / 180;
  form.direction = edit.direction;
  return with_closed_form(scene, edit.target, edit.axis, form);
}

std::string done_words(const Bend& edit) { return fmt::format("Bent by {:.4g}°:", edit.degrees); }

REBAKE_DESCRIBE_EDIT(
    Bend, "Bends triangles so that the axis becomes an arc of the same length; parts beyond the limits move rigidly.",
    (auto& edit, auto& visit) {
      DeformTarget::fields(edit.target, visit);
      visit("degrees", edit.degrees, Need::required, "angle between both limits", Unit::degrees);
      DeformAxis::fields(edit.axis, visit);
      visit("direction", edit.direction, Need::optional,
            "direction of the bend; only its part orthogonal to the axis counts; if it is nearly parallel to an "
            "automatic axis, "
            "the world axis most across that is taken");
    })

}  // namespace rebake
