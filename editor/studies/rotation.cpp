#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>

#include "editor/studies/deforming.h"
#include "editor/studies/gradient_binding.h"
#include "editor/studies/study.h"
#include "mesh_ops/base/polar.h"
#include "mesh_ops/deform/cage_deformation.h"

namespace rebake {

namespace {

// The largest and the mean angle between rotations, in degrees.
std::pair<double, double> angles(const std::vector<Mat3>& a, const std::vector<Mat3>& b) {
  double worst = 0, sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    // By the chord, which small angles do not lose: ‖A − B‖ = 2√2 sin(angle / 2).
    const double chord = std::min(1.0, (a[k] - b[k]).norm() / (2 * std::numbers::sqrt2));
    const double angle = 2 * std::asin(chord) * 180 / std::numbers::pi;
    worst = std::max(worst, angle);
    sum += angle;
  }
  return {worst, sum / static_cast<double>(a.size())};
}

// Jacobians of the cage's motion, by weights that carry their gradients.
template <class T>
std::vector<Mat3> jacobians_by(const std::vector<Vec3>& points, const Cage& cage, const std::vector<Vec3>& moved) {
  const CageFrame frame = frame_of(cage);
  std::vector<Mat3> result(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t k) {
    std::vector<T> weights;
    mean_value_weights(frame, frame.to_local(points[k]), weights);
    using Real = decltype(T().v);
    Eigen::Matrix<Real, 3, 3> jacobian = Eigen::Matrix<Real, 3, 3>::Identity();
    for (std::size_t v = 0; v < weights.size(); ++v)
      jacobian += (moved[v] - cage.vertices[v]).template cast<Real>() *
                  Eigen::Matrix<Real, 1, 3>(weights[v].x, weights[v].y, weights[v].z) * static_cast<Real>(frame.scale);
    result[k] = jacobian.template cast<double>();
  });
  return result;
}

}  // namespace

StudyTable study_rotation(const StudyInput& input) {
  const StudySoup soup = study_soup(input.scene);
  const Cage cage = wrap(soup.opaque, 0.1);
  const std::vector<Vec3> moved = twisted(cage);
  const auto coordinates = mean_value_coordinates(cage);
  StudyTable table{{"milliseconds", "worst, degrees", "mean, degrees"}, {}, 0, 1, true, true};

  // What all are compared with: dual numbers in long double, and their singular value decomposition.
  std::vector<Mat3> reference = jacobians_by<LongDual>(soup.places, cage, moved);
  for (Mat3& jacobian : reference) jacobian = svd_rotation(jacobian).rotation;
  const DeformedPoints exact = deform_points(*coordinates, cage, moved, soup.places, true);
  const auto add = [&](const std::string& name, double time, const std::vector<Mat3>& rotations) {
    const auto [worst, mean] = angles(rotations, reference);
    table.rows.push_back({name, {time, worst, mean}});
    input.progress.at(name, static_cast<double>(table.rows.size()) / 14);
  };

  std::vector<Mat3> rotations(soup.places.size());
  double time = median_milliseconds(1, [&] {
    const std::vector<Mat3> jacobians = jacobians_by<Dual>(soup.places, cage, moved);
    for (std::size_t k = 0; k < rotations.size(); ++k) rotations[k] = local_rotation(jacobians[k]).rotation;
  });
  add("dual numbers, point by point", time, rotations);
  const double weigh = median_milliseconds(1, [&] { deform_points(*coordinates, cage, moved, soup.places, true); });
  const auto polar = [&](LocalRotation (*factor)(const Mat3&)) {
    return median_milliseconds(input.frames, [&] {
      for (std::size_t k = 0; k < rotations.size(); ++k) rotations[k] = factor(exact.jacobians[k]).rotation;
    });
  };
  time = polar([](const Mat3& j) { return LocalRotation{newton_polar_factor(j), true}; });
  add("gradients, Newton", weigh + time, rotations);
  time = polar(svd_rotation);
  add("gradients, SVD", weigh + time, rotations);
  time = polar(local_rotation);
  add("gradients, Newton or SVD", weigh + time, rotations);

  for (const double share : {1e-3, 1e-5, 1e-7}) {
    const double step = share * soup.diagonal;
    std::vector<Mat3> jacobians(soup.places.size());
    time = median_milliseconds(1, [&] {
      for (int axis = 0; axis < 3; ++axis) {
        std::vector<Vec3> low = soup.places, high = soup.places;
        for (Vec3& p : low) p[axis] -= step;
        for (Vec3& p : high) p[axis] += step;
        const auto below = deform_points(*coordinates, cage, moved, low, false).points,
                   above = deform_points(*coordinates, cage, moved, high, false).points;
        for (std::size_t k = 0; k < jacobians.size(); ++k) jacobians[k].col(axis) = (above[k] - below[k]) / (2 * step);
      }
      for (std::size_t k = 0; k < rotations.size(); ++k) rotations[k] = local_rotation(jacobians[k]).rotation;
    });
    add(fmt::format("finite differences, step {:g}", share), time, rotations);
  }

  const GradientBinding binding(*coordinates, cage, soup.places);
  for (const std::size_t stride : {1U, 4U, 16U, 64U})
    for (const bool interpolated : {false, true}) {
      if (stride == 1 && interpolated) continue;
      time = median_milliseconds(input.frames, [&] { binding.rotations(moved, rotations, stride, interpolated); });
      add(stride == 1 ? std::string("kept gradients")
                      : fmt::format("1 in {}, {}", stride, interpolated ? "interpolated" : "the nearest"),
          time, rotations);
    }
  return table;
}

}  // namespace rebake
