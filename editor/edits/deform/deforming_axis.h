#pragma once

#include "editor/edits/deform/deforming.h"
#include "mesh_ops/deform/bends/closed_form.h"

namespace rebake {

/// Axis and limits of a deformation.
struct DeformAxis {
  AxisDirection axis;              ///< direction in world space; automatic: the spine of the triangles
  std::optional<Vec3> origin;      ///< world point on the axis; nothing: lower end of the box, in its middle
  std::optional<double> from, to;  ///< limits along the axis from the origin; nothing: the triangles' ends
  PolyLine spine;                  ///< curved axis; limits are then arc lengths along it

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("axis", self.axis, Need::optional,
          "direction of the axis in world space; auto: along the part, from where it is attached, following its centre "
          "line (tapers: straight); origin and spine must then be left out");
    visit(
        "origin", self.origin, Need::optional,
        "world point on the axis; default: the axis runs through the middle of the triangles' box, from its lower end");
    visit("spine", self.spine, Need::optional,
          "world points of a curved axis; the straight axis then only defines the plane of the bend; from and to "
          "are arc lengths along the curve; not for tapers");
    visit("from", self.from, Need::optional,
          "lower limit along the axis, from the origin; default: lower end of the triangles", Unit::length);
    visit("to", self.to, Need::optional, "upper limit; default: upper end of the triangles", Unit::length);
  }
};

/// A closed form along a straight axis, or along `spine` if it is not empty.
struct AxisForm {
  ClosedForm form;
  std::vector<Vec3> spine;
};
/// Completes `form` with the axis and limits for the triangles of `set`, which are those of `target`. Throws as check()
/// does.
AxisForm axis_form(const Scene& scene, const DeformSet& set, const DeformTarget& target, const DeformAxis& axis,
                   ClosedForm form);

/// Completes `form` with the axis and limits, along the spine if there is one, and deforms the target. Throws as
/// deform_set(), check() and along_curve() do.
Outcome with_closed_form(const Scene& scene, const DeformTarget& target, const DeformAxis& axis, ClosedForm form);

}  // namespace rebake
