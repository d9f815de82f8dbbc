#pragma once

#include <tbb/parallel_for.h>

#include "mesh_ops/deform/bends/curved_form.h"
#include "mesh_ops/deform/deform_positions.h"

namespace rebake {

/// The deformation of space by a ClosedForm or CurvedForm.
template <class Form>
SpaceDeformation deformation_by(const Form& form) {
  return [form](const std::vector<Vec3>& points) {
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
}

}  // namespace rebake
