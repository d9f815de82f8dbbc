#include "editor/edits/deform/deforming_axis.h"

#include <tbb/parallel_for.h>

namespace rebake {

Outcome with_closed_form(const Scene& scene, const DeformTarget& target, const DeformAxis& axis, ClosedForm form) {
  const DeformSet set = deform_set(scene, target);
  if (!axis.axis.allFinite() || !(axis.axis.stableNorm() > 0)) throw FieldError("axis", "must have a length");
  form.axis = axis.axis.stableNormalized();
  const auto [low, high] = set.extent_along(form.axis);
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
  return with_deformed(scene, set, target.falloff, [&](const std::vector<Vec3>& points) {
    DeformedPoints result;
    result.points.resize(points.size());
    result.jacobians.resize(points.size());
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
      const Deformed one = deform(form, points[i]);
      result.points[i] = one.point;
      result.jacobians[i] = one.jacobian;
    });
    return result;
  });
}

}  // namespace rebake
