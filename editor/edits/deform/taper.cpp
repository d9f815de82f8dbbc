#include "editor/edits/deform/taper.h"

#include <fmt/format.h>

#include "editor/edits/describe_edit.h"

namespace rebake {

Outcome apply(const Scene& scene, const Taper& edit) {
  ClosedForm form;
  form.kind = ClosedForm::Kind::taper;
  form.factor = edit.factor;
  return with_closed_form(scene, edit.target, edit.axis, form);
}

std::string done_words(const Taper& edit) { return fmt::format("Tapered by {:.4g}:", edit.factor); }

REBAKE_DESCRIBE_EDIT(
    Taper, "Tapers triangles: scales them orthogonally to an axis, increasingly between the limits.",
    (auto& edit, auto& visit) {
      DeformTarget::fields(edit.target, visit);
      visit("factor", edit.factor, Need::required, "size at the upper limit, relative to the present one",
            Unit::factor);
      DeformAxis::fields(edit.axis, visit);
    })

}  // namespace rebake
