#pragma once

#include <span>
#include <vector>

#include "mesh_ops/deform/far_quadrature.h"
#include "mesh_ops/deform/plane_local.h"
#include "mesh_ops/deform/wide_frame.h"

// Weights of points on and beside the cage. There a face's term grows without bound while the normalised weights stay
// smooth, and near a sharp edge the terms of both faces hang on heights that double cannot resolve. So the faces near a
// point are evaluated with 50 digits, unless a single face is near and the point lies over it: that case has a smooth
// form.

namespace rebake {

/// Faces nearer than this (local units) are evaluated apart from the others.
inline constexpr double near_distance = 1e-6;

using WideDual = DualOf<Wide>;
using WidePoint = std::array<Wide, 3>;

/// Turns `weights`, the sums over all faces but the `near` ones (one per vertex), into normalised mean value weights.
/// Gradients on the surface are one-sided limits from inside.
template <class T>
void add_near_faces(const CageFrame& cage, const plane_local::Point<T>& local, std::span<const FaceFrame* const> near,
                    std::vector<T>& weights);

/// Green's terms of the near faces (times 4π), one per near face, in type W: Wide at `point` itself, or WideDual with
/// gradients, at `point` or at their limit from inside when it lies on the surface. Empty when double is enough. Sum
/// them before rounding to double: terms of faces that share an edge cancel.
template <class W>
std::vector<plane_local::GreenTerms<W>> wide_green_terms(const CageFrame& cage, const Vec3& point,
                                                         std::span<const FaceFrame* const> near);

// For add_near_faces alone.
namespace near_faces {

/// Normalised weights from `sums`, the sums over all other faces.
std::vector<Wide> wide_values(const CageFrame& cage, const WidePoint& point, std::span<const FaceFrame* const> near,
                              std::vector<Wide> sums);
/// The same with gradients; the values are those of the place where gradients are taken.
std::vector<WideDual> wide_gradients(const CageFrame& cage, const WidePoint& point,
                                     std::span<const FaceFrame* const> near, std::vector<WideDual> sums);

template <class T>
bool is_over(const plane_local::Seen<T>& s) {
  const double height = std::abs(value_of(s.h));
  return value_of(s.a[0]) > height && value_of(s.a[1]) > height && value_of(s.a[2]) > height;
}

template <class T>
void normalise(std::vector<T>& weights) {
  T total = plane_local::constant<T>(0);
  for (const T& weight : weights) total += weight;
  for (T& weight : weights) weight = weight / total;
}

// The one face that the point is over, or on.
template <class T>
void add_face_below(const FaceFrame& face, plane_local::Seen<T> s, std::vector<T>& weights) {
  // A height within rounding is 0 for the weights; their gradients keep its derivative.
  if (plane_local::place(s) == plane_local::Place::on_face) s.h = s.h - plane_local::constant<T>(value_of(s.h));
  const plane_local::OverFace<T> over = plane_local::over_face(face, s);
  T total = plane_local::constant<T>(0);
  for (const T& weight : weights) total += weight;
  const T divisor = plane_local::constant<T>(1) + over.width * total;
  for (T& weight : weights) weight = over.width * weight / divisor;
  for (std::size_t k = 0; k < 3; ++k)
    weights[face.vertices[k]] += (over.lambda[k] + over.width * over.rest[k]) / divisor;
}

template <class T>
Wide wide_value(const T& number) {
  return Wide(number);
}
template <class R>
Wide wide_value(const DualOf<R>& number) {
  return Wide(number.v);
}
template <class T>
WidePoint wide_values_of(const plane_local::Point<T>& p) {
  return {wide_value(p[0]), wide_value(p[1]), wide_value(p[2])};
}

}  // namespace near_faces

template <class T>
void add_near_faces(const CageFrame& cage, const plane_local::Point<T>& local, std::span<const FaceFrame* const> near,
                    std::vector<T>& weights) {
  if (near.empty()) return near_faces::normalise(weights);
  if (near.size() == 1) {
    const plane_local::Seen<T> s = plane_local::seen(cage, *near.front(), local);
    if (near_faces::is_over(s)) return near_faces::add_face_below(*near.front(), s, weights);
  }
  using R = typename plane_local::RealOf<T>::type;
  const WidePoint point = near_faces::wide_values_of(local);
  std::vector<Wide> sums;
  for (const T& weight : weights) sums.push_back(near_faces::wide_value(weight));
  const std::vector<Wide> values = near_faces::wide_values(cage, point, near, std::move(sums));
  if constexpr (plane_local::has_gradient<T>) {
    std::vector<WideDual> duals;
    for (const T& weight : weights) duals.push_back({Wide(weight.v), Wide(weight.x), Wide(weight.y), Wide(weight.z)});
    duals = near_faces::wide_gradients(cage, point, near, std::move(duals));
    for (std::size_t v = 0; v < values.size(); ++v)
      weights[v] = T(static_cast<R>(values[v]), static_cast<R>(duals[v].x), static_cast<R>(duals[v].y),
                     static_cast<R>(duals[v].z));
  } else {
    for (std::size_t v = 0; v < values.size(); ++v) weights[v] = static_cast<R>(values[v]);
  }
}

}  // namespace rebake
