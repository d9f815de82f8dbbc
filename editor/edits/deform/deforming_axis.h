#pragma once

#include "editor/edits/deform/deforming.h"
#include "mesh_ops/deform/closed_form.h"

namespace rebake {

/// Fields of deformations about an axis.
struct DeformAxis {
  Vec3 axis{0, 1, 0};
  std::optional<Vec3> origin;
  std::optional<double> from, to;
  PolyLine spine;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("axis", self.axis, Need::optional, "direction of the axis, in world axes");
    visit("origin", self.origin, Need::optional,
          "world point on the axis; left out: where it enters the box of what is deformed, in the middle");
    visit("spine", self.spine, Need::optional,
          "world points of a curved line in place of the axis, which then only says across what it bends; from and to "
          "are lengths along it; not for tapers");
    visit("from", self.from, Need::optional,
          "where it begins along the axis, from the origin; left out: where the triangles begin", Unit::length);
    visit("to", self.to, Need::optional, "where it ends; left out: where the triangles end", Unit::length);
  }
};

/// Fills in the form's axis and deforms.
Outcome with_closed_form(const Scene& scene, const DeformTarget& target, const DeformAxis& axis, ClosedForm form);

}  // namespace rebake
