#include "editor/edits/deform/stretch.h"

#include <fmt/format.h>

#include "editor/edits/describe_edit.h"

namespace rebake {

Outcome apply(const Scene& scene, const Stretch& edit) {
  ClosedForm form;
  form.kind = ClosedForm::Kind::stretch;
  form.factor = edit.factor;
  return with_closed_form(scene, edit.target, edit.axis, form);
}

std::string done_words(const Stretch& edit) { return fmt::format("Stretched by {:.4g}:", edit.factor); }

REBAKE_DESCRIBE_EDIT(
    Stretch, "Stretches triangles along an axis between the limits.", (auto& edit, auto& visit) {
      DeformTarget::fields(edit.target, visit);
      visit("factor", edit.factor, Need::required, "new length between the limits, relative to the present one",
            Unit::factor);
      DeformAxis::fields(edit.axis, visit);
    })

}  // namespace rebake
