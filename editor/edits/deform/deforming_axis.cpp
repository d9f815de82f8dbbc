#include "editor/edits/deform/deforming_axis.h"

#include <tbb/parallel_for.h>

#include "mesh_ops/deform/curved_form.h"

namespace rebake {

namespace {

// Form: ClosedForm or CurvedForm.
template <class Form>
Outcome with_form(const Scene& scene, const DeformSet& set, const DeformTarget& target, const Form& form,
                  const std::vector<std::string>& notes = {}) {
  const SpaceDeformation deformation = [&](const std::vector<Vec3>& points) {
    DeformedPoints result;
    result.points.resize(points.size());
    result.jacobians.resize(points.size());
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
      const Deformed one = deform(form, points[i]);
      result.points[i] = one.point;
      result.jacobians[i] = one.jacobian;
    });
    return result;
  };
  return with_deformed(scene, set, target.falloff, deformation, notes);
}

std::vector<std::string> spine_warnings(const std::vector<Vec3>& spine) {
  for (std::size_t k = 1; k + 1 < spine.size(); ++k)
    if ((spine[k + 1] - spine[k]).dot(spine[k] - spine[k - 1]) < 0)
      return {"the spine has a corner of more than 90° at point " + std::to_string(k) +
              " (counted from 0), where triangles may tear; round the corner by more points"};
  return {};
}

}  // namespace

Outcome with_closed_form(const Scene& scene, const DeformTarget& target, const DeformAxis& axis, ClosedForm form) {
  const DeformSet set = deform_set(scene, target);
  if (!axis.axis.allFinite() || !(axis.axis.stableNorm() > 0)) throw FieldError("axis", "must be finite and not zero");
  form.axis = axis.axis.stableNormalized();
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
    return with_form(scene, set, target, along_curve(form, axis.spine.points), spine_warnings(axis.spine.points));
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
  return with_form(scene, set, target, form);
}

}  // namespace rebake
