#pragma once

#include "editor/edits/deform/deforming.h"
#include "mesh_ops/deform/closed_form.h"

namespace rebake {

/// Axis and limits of a deformation.
struct DeformAxis {
  Vec3 axis{0, 1, 0};              ///< direction in world space, any length but 0
  std::optional<Vec3> origin;      ///< world point on the axis; nothing: lower end of the box, in its middle
  std::optional<double> from, to;  ///< limits along the axis from the origin; nothing: the triangles' ends
  PolyLine spine;                  ///< curved axis; limits are then arc lengths along it

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

/// Completes `form` with the axis and limits, along the spine if there is one, and deforms the target. Throws as
/// deform_set(), check() and along_curve() do.
Outcome with_closed_form(const Scene& scene, const DeformTarget& target, const DeformAxis& axis, ClosedForm form);

}  // namespace rebake
