#pragma once

#include <span>
#include <vector>

#include "mesh_ops/deform/cage_coordinates/far_quadrature.h"
#include "mesh_ops/deform/cage_coordinates/plane_local.h"
#include "mesh_ops/deform/cage_coordinates/wide_frame.h"

// Weights of points on and beside the cage. There a face's term grows without bound while the normalised weights stay
// smooth. Near a sharp edge, the terms of both faces depend on heights that double cannot resolve. So the faces near a
// point are evaluated with 50 digits. The exception is a point over a single near face, which has a smooth form.

namespace rebake {

using WidePoint = std::array<Wide, 3>;

/// Faces nearer than this (local units) are evaluated separately. The diagonal of a cage is 1 to 2 local units, so this
/// covers 1e-6 diagonals of any cage.
inline constexpr double near_distance = 2e-6;

/// If the sums over the other faces are as large as this (local units), they come from faces on the far side of a thin
/// part. Weights then change so fast across the part that the height over the near face needs more than double.
inline constexpr double large_others = 64;

using WideDual = DualOf<Wide>;

/// Adds the `near` faces to `weights`, the sums over all other faces (one per vertex), and normalises them to mean
/// value weights. Gradients on the surface are one-sided limits from inside. Returns the divisor of the normalisation
/// with its sign, infinite on the surface: rounding errors of the given sums divided by it are in the weights. `exact`:
/// the point in local units, before it was rounded to double.
template <class T>
double add_near_faces(const CageFrame& cage, const plane_local::Point<T>& local, const WidePoint& exact,
                      std::span<const FaceFrame* const> near, std::vector<T>& weights);

/// Green's terms of the near faces (times 4π), one per near face. Sum them before rounding to double, since terms of
/// faces that share an edge cancel.
struct WideGreen {
  std::vector<plane_local::GreenTerms<Wide>> terms;  ///< empty if double is enough
  double sum = 0;                                    ///< sum over all corners, divided by 4π
  /// The sum at a point just inside, if the point lies on the surface; there `sum` depends on the number of faces that
  /// meet. Otherwise equal to `sum`.
  double sum_inside = 0;
};
WideGreen wide_green(const CageFrame& cage, const WidePoint& exact, std::span<const FaceFrame* const> near);
/// Terms with gradients, at the point, or at the limit from inside if it lies on the surface.
std::vector<plane_local::GreenTerms<WideDual>> wide_green_gradients(const CageFrame& cage, const WidePoint& exact,
                                                                    std::span<const FaceFrame* const> near);

// Helpers of add_near_faces().
namespace near_faces {

/// Normalised weights from `sums`, the sums over all other faces. Sets `divisor` as add_near_faces() returns it.
std::vector<Wide> wide_values(const CageFrame& cage, const WidePoint& point, std::span<const FaceFrame* const> near,
                              std::vector<Wide> sums, double& divisor);
/// Weights with gradients. Values and gradients belong to the point where gradients are taken.
std::vector<WideDual> wide_gradients(const CageFrame& cage, const WidePoint& point,
                                     std::span<const FaceFrame* const> near, std::vector<WideDual> sums);

/// Whether the point is over the face: its projection is farther inside every edge than the point's height.
template <class T>
bool is_over(const plane_local::Seen<T>& s) {
  const double height = std::abs(value_of(s.h));
  return value_of(s.a[0]) > height && value_of(s.a[1]) > height && value_of(s.a[2]) > height;
}

// Divides the weights by their sum. Returns the sum.
template <class T>
double normalise(std::vector<T>& weights) {
  T total = plane_local::constant<T>(0);
  for (const T& weight : weights) total += weight;
  for (T& weight : weights) weight = weight / total;
  return value_of(total);
}

// Adds the single face that the point is over or on. Returns the same as add_near_faces().
template <class T>
double add_face_under_point(const FaceFrame& face, plane_local::Seen<T> s, std::vector<T>& weights) {
  // A height within rounding is 0 for the weights; their gradients keep its derivative.
  if (plane_local::place(s) == plane_local::Place::on_face) s.h = s.h - plane_local::constant<T>(value_of(s.h));
  const plane_local::OverFace<T> over = plane_local::over_face(face, s);
  T total = plane_local::constant<T>(0);
  for (const T& weight : weights) total += weight;
  const T divisor = plane_local::constant<T>(1) + over.width * total;
  for (T& weight : weights) weight = over.width * weight / divisor;
  for (std::size_t k = 0; k < 3; ++k)
    weights[face.vertices[k]] += (over.lambda[k] + over.width * over.rest[k]) / divisor;
  return value_of(divisor) / value_of(over.width);
}

template <class T>
Wide wide_value(const T& number) {
  return Wide(number);
}
template <class R>
Wide wide_value(const DualOf<R>& number) {
  return Wide(number.v);
}
}  // namespace near_faces

template <class T>
double add_near_faces(const CageFrame& cage, const plane_local::Point<T>& local, const WidePoint& exact,
                      std::span<const FaceFrame* const> near, std::vector<T>& weights) {
  if (near.empty()) return near_faces::normalise(weights);
  double others = 0;
  for (const T& weight : weights) others += std::abs(value_of(weight));
  if (near.size() == 1 && others < large_others) {
    const plane_local::Seen<T> s = plane_local::seen(cage, *near.front(), local);
    if (near_faces::is_over(s)) return near_faces::add_face_under_point(*near.front(), s, weights);
  }
  using R = typename plane_local::RealOf<T>::type;
  std::vector<Wide> sums;
  for (const T& weight : weights) sums.push_back(near_faces::wide_value(weight));
  double divisor = 0;
  const std::vector<Wide> values = near_faces::wide_values(cage, exact, near, std::move(sums), divisor);
  if constexpr (plane_local::has_gradient<T>) {
    std::vector<WideDual> duals;
    for (const T& weight : weights) duals.push_back({Wide(weight.v), Wide(weight.x), Wide(weight.y), Wide(weight.z)});
    duals = near_faces::wide_gradients(cage, exact, near, std::move(duals));
    for (std::size_t v = 0; v < values.size(); ++v)
      weights[v] = T(static_cast<R>(values[v]), static_cast<R>(duals[v].x), static_cast<R>(duals[v].y),
                     static_cast<R>(duals[v].z));
  } else {
    for (std::size_t v = 0; v < values.size(); ++v) weights[v] = static_cast<R>(values[v]);
  }
  return divisor;
}

}  // namespace rebake
