#include "editor/edits/deform/deforming_axis.h"

#include "editor/edits/deform/target_spine.h"
#include "mesh_ops/deform/form_deformation.h"

namespace rebake {

namespace {

std::vector<std::string> spine_warnings(const std::vector<Vec3>& spine) {
  for (std::size_t k = 1; k + 1 < spine.size(); ++k)
    if ((spine[k + 1] - spine[k]).dot(spine[k] - spine[k - 1]) < 0)
      return {"the spine has a corner of more than 90° at point " + std::to_string(k) +
              " (counted from 0), where triangles may tear; round the corner by more points"};
  return {};
}

}  // namespace

namespace {

// The axis along the part's spine. Tapers need a straight one.
DeformAxis found_axis(const Scene& scene, const DeformTarget& target, DeformAxis axis, ClosedForm::Kind kind) {
  if (axis.origin) throw FieldError("origin", "cannot be combined with an automatic axis; leave it out");
  if (!axis.spine.points.empty()) throw FieldError("spine", "cannot be combined with an automatic axis; leave it out");
  const Spine spine = spine_of_targets(scene, {target});
  if (!(spine.length > 0)) throw EditError("the triangles have no axis that can be found; set axis to a direction");
  axis.axis = spine.along;
  if (kind == ClosedForm::Kind::taper || spine.curve.size() < 2)
    axis.origin = spine.foot;
  else
    axis.spine.points = spine.curve;
  return axis;
}

// `direction`, or if it is nearly parallel to an axis that was found, the world axis that is most across it.
Vec3 beside(const Vec3& axis, const Vec3& direction) {
  constexpr double nearly_parallel = 0.05;
  if ((direction - direction.dot(axis) * axis).stableNorm() > nearly_parallel * direction.stableNorm())
    return direction;
  Eigen::Index across = 0;
  axis.cwiseAbs().minCoeff(&across);
  return Vec3::Unit(across);
}

}  // namespace

AxisForm axis_form(const Scene& scene, const DeformSet& set, const DeformTarget& target, const DeformAxis& given,
                   ClosedForm form) {
  const DeformAxis axis = given.axis.automatic ? found_axis(scene, target, given, form.kind) : given;
  const Vec3& along = axis.axis.direction;
  if (!along.allFinite() || !(along.stableNorm() > 0)) throw FieldError("axis", "must be finite and not zero");
  form.axis = along.stableNormalized();
  if (given.axis.automatic && form.kind == ClosedForm::Kind::bend) form.direction = beside(form.axis, form.direction);
  const auto [low, high] = set.extent_along(form.axis);
  if (!axis.spine.points.empty()) {
    if (axis.origin) throw FieldError("origin", "cannot be combined with spine, which begins at its first point");
    if (axis.spine.points.size() < 2) throw FieldError("spine", "must have at least two points");
    double length = 0;
    for (std::size_t k = 0; k + 1 < axis.spine.points.size(); ++k)
      length += (axis.spine.points[k + 1] - axis.spine.points[k]).stableNorm();
    form.from = axis.from.value_or(0);
    form.to = axis.to.value_or(length);
    check(form);
    return {form, axis.spine.points};
  }
  if (axis.origin) {
    form.origin = *axis.origin;
  } else {
    const Vec3 middle = set.bounds().center();
    form.origin = middle + form.axis * (low - middle.dot(form.axis));
  }
  const double start = form.origin.dot(form.axis);
  form.from = axis.from.value_or(low - start);
  form.to = axis.to.value_or(high - start);
  check(form);
  return {form, {}};
}

Outcome with_closed_form(const Scene& scene, const DeformTarget& target, const DeformAxis& axis, ClosedForm form) {
  const DeformSet set = deform_set(scene, target);
  const AxisForm made = axis_form(scene, set, target, axis, std::move(form));
  if (made.spine.empty()) return with_deformed(scene, set, target.falloff, deformation_by(made.form));
  return with_deformed(scene, set, target.falloff, deformation_by(along_curve(made.form, made.spine)),
                       spine_warnings(made.spine));
}

}  // namespace rebake
