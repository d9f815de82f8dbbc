#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "editor/studies/gradient_binding.h"
#include "editor/studies/hard_points.h"
#include "editor/studies/study.h"
#include "editor/studies/study_soup.h"
#include "mesh_ops/base/polar.h"
#include "mesh_ops/deform/cage_coordinates/cage_deformation.h"

namespace rebake {

namespace {

// The largest and the mean angle between rotations, in degrees.
std::pair<double, double> angles(const std::vector<Mat3>& a, const std::vector<Mat3>& b) {
  double worst = 0, sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    // From the chord ‖A − B‖ = 2√2 sin(angle / 2), which is accurate for small angles.
    const double chord = std::min(1.0, (a[k] - b[k]).norm() / (2 * std::numbers::sqrt2));
    const double angle = 2 * std::asin(chord) * 180 / std::numbers::pi;
    worst = std::max(worst, angle);
    sum += angle;
  }
  return {worst, sum / static_cast<double>(a.size())};
}

// Jacobians of the deformation from mean value weights in dual numbers of type T, which carry gradients.
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

// Jacobians of the deformation from central differences.
std::vector<Mat3> differences(const Coordinates& coordinates, const Cage& cage, const std::vector<Vec3>& moved,
                              const std::vector<Vec3>& points, double step) {
  std::vector<Mat3> jacobians(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Vec3> low = points, high = points;
    for (Vec3& p : low) p[axis] -= step;
    for (Vec3& p : high) p[axis] += step;
    const auto below = deform_points(coordinates, cage, moved, low, false).points,
               above = deform_points(coordinates, cage, moved, high, false).points;
    for (std::size_t k = 0; k < jacobians.size(); ++k) jacobians[k].col(axis) = (above[k] - below[k]) / (2 * step);
  }
  return jacobians;
}

// A method to compute local rotations of points from a cage's motion.
using Method = std::function<std::vector<Mat3>(const Coordinates&, const Cage&, const std::vector<Vec3>& moved,
                                               const std::vector<Vec3>& points)>;

std::vector<Mat3> factors(const std::vector<Mat3>& jacobians, LocalRotation (*factor)(const Mat3&)) {
  std::vector<Mat3> result;
  for (const Mat3& jacobian : jacobians) result.push_back(factor(jacobian).rotation);
  return result;
}

// Largest error of a method at hard_points(), where the exact rotation is known; degrees.
double hard_angle(const Method& method) {
  double worst = 0;
  for (const HardPoints& hard : hard_points()) {
    const auto coordinates = mean_value_coordinates(hard.cage);
    const std::vector<Mat3> got = method(*coordinates, hard.cage, hard.moved, hard.points);
    worst = std::max(worst, angles(got, std::vector<Mat3>(got.size(), hard.turn)).first);
  }
  return worst;
}

}  // namespace

StudyTable study_rotation(const StudyInput& input) {
  const StudySoup soup = study_soup(input.scene);
  const Cage cage = wrap(soup.opaque, 0.1);
  const std::vector<Vec3> moved = twisted(cage);
  const auto coordinates = mean_value_coordinates(cage);
  StudyTable table{
      {"milliseconds", "worst, degrees", "mean, degrees", "worst at hard points, degrees"}, {}, 0, 1, true, true};

  // Reference: dual numbers in long double, and singular value decomposition.
  std::vector<Mat3> reference = jacobians_by<LongDual>(soup.places, cage, moved);
  for (Mat3& jacobian : reference) jacobian = svd_rotation(jacobian).rotation;
  const DeformedPoints exact = deform_points(*coordinates, cage, moved, soup.places, true);
  const auto add = [&](const std::string& name, double time, const std::vector<Mat3>& rotations, const Method& method) {
    const auto [worst, mean] = angles(rotations, reference);
    table.rows.push_back({name, {time, worst, mean, method ? hard_angle(method) : std::nan("")}});
    input.progress.at(name, static_cast<double>(table.rows.size()) / 14);
  };

  std::vector<Mat3> rotations(soup.places.size());
  const Method dual = [](const Coordinates&, const Cage& rest, const std::vector<Vec3>& to,
                         const std::vector<Vec3>& points) {
    return factors(jacobians_by<Dual>(points, rest, to), local_rotation);
  };
  double time = median_milliseconds(1, [&] { rotations = dual(*coordinates, cage, moved, soup.places); });
  add("dual numbers, point by point", time, rotations, dual);
  const double compute_weights =
      median_milliseconds(1, [&] { deform_points(*coordinates, cage, moved, soup.places, true); });
  const auto add_polar = [&](const std::string& name, LocalRotation (*factor)(const Mat3&)) {
    const double polar = median_milliseconds(input.frames, [&] { rotations = factors(exact.jacobians, factor); });
    add(name, compute_weights + polar, rotations,
        [&](const Coordinates& of, const Cage& rest, const std::vector<Vec3>& to, const std::vector<Vec3>& points) {
          return factors(deform_points(of, rest, to, points, true).jacobians, factor);
        });
  };
  add_polar("gradients, Newton", [](const Mat3& j) { return LocalRotation{newton_polar_factor(j), true}; });
  add_polar("gradients, SVD", svd_rotation);
  add_polar("gradients, Newton or SVD", local_rotation);

  for (const double share : {1e-3, 1e-5, 1e-7}) {
    const auto by_step = [](double step) -> Method {
      return [step](const Coordinates& of, const Cage& rest, const std::vector<Vec3>& to,
                    const std::vector<Vec3>& points) {
        return factors(differences(of, rest, to, points, step), local_rotation);
      };
    };
    const Method method = by_step(share * soup.diagonal);
    time = median_milliseconds(1, [&] { rotations = method(*coordinates, cage, moved, soup.places); });
    add(fmt::format("finite differences, step {:g}", share), time, rotations, by_step(share));
  }

  const GradientBinding binding(*coordinates, cage, soup.places);
  for (const std::size_t stride : {1U, 4U, 16U, 64U})
    for (const bool interpolated : {false, true}) {
      if (stride == 1 && interpolated) continue;
      time = median_milliseconds(input.frames, [&] { binding.rotations(moved, rotations, stride, interpolated); });
      if (stride == 1)
        add("cached gradients", time, rotations,
            [](const Coordinates& of, const Cage& rest, const std::vector<Vec3>& to, const std::vector<Vec3>& points) {
              std::vector<Mat3> result(points.size());
              GradientBinding(of, rest, points).rotations(to, result);
              return result;
            });
      else  // hard_points() rotate rigidly, where skipping points causes no error
        add(fmt::format("1 in {}, {}", stride, interpolated ? "interpolated" : "nearest"), time, rotations, {});
    }
  return table;
}

}  // namespace rebake
