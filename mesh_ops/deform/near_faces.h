#pragma once

#include <span>
#include <vector>

#include "mesh_ops/deform/far_quadrature.h"
#include "mesh_ops/deform/plane_local.h"
#include "mesh_ops/deform/wide_frame.h"

// Weights of points on and beside the cage. There a face's term grows without bound while the weights stay smooth: in
// double, what is left of them after dividing by their sum is right, but their gradients are rounding over distance.

namespace rebake {

/// Nearer than this (local units) a face is weighed apart from the others.
inline constexpr double near_distance = 1e-6;

template <class T>
double distance_of(const plane_local::Seen<T>& s) {
  return std::max(std::abs(value_of(s.h)), plane_local::distance_in_plane(s));
}

/// Mean value weights, normalised, from `weights`: one a vertex, the sums over all faces but the `near` ones. Gradients
/// on the surface are one-sided limits from inside.
template <class T>
void add_near_faces(const CageFrame& cage, const plane_local::Point<T>& local, std::span<const FaceFrame* const> near,
                    std::vector<T>& weights);

/// Gradients of what near faces weigh by Green's coordinates (times 4π), where double does not hold them: `terms` keep
/// their values. Returns whether it had to.
bool mend_gradients(const CageFrame& cage, const plane_local::Point<Dual>& local,
                    std::span<const FaceFrame* const> near, std::span<plane_local::GreenTerms<Dual>> terms);

using WideDual = DualOf<Quad>;

// For add_near_faces alone.
namespace near_faces {

/// Nearer than this to an edge, double leaves less than eight digits of a gradient.
inline constexpr double quad_distance = 1e-8;
/// From the nearest of `near`.
double least_distance(const CageFrame& cage, const Vec3& local, std::span<const FaceFrame* const> near);
/// Mean value weights with their gradients, normalised, in 113 bits; `sums` as for add_near_faces.
std::vector<WideDual> wide_weights(const CageFrame& cage, const Vec3& local, std::span<const FaceFrame* const> near,
                                   std::vector<WideDual> sums);

template <class T>
bool is_over(const plane_local::Seen<T>& s) {
  const double height = std::abs(value_of(s.h));
  return value_of(s.a[0]) > height && value_of(s.a[1]) > height && value_of(s.a[2]) > height;
}

template <class T>
Vec3 values_of(const plane_local::Point<T>& p) {
  return {value_of(p[0]), value_of(p[1]), value_of(p[2])};
}

template <class R>
void set_gradient(DualOf<R>& to, const WideDual& from) {
  to.x = static_cast<R>(from.x);
  to.y = static_cast<R>(from.y);
  to.z = static_cast<R>(from.z);
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
  // Rounding's height: to the face's weights it is none, to their gradients it is the height's own.
  if (plane_local::place(s) == plane_local::Place::on_face) s.h = s.h - plane_local::constant<T>(value_of(s.h));
  const plane_local::OverFace<T> over = plane_local::over_face(face, s);
  T total = plane_local::constant<T>(0);
  for (const T& weight : weights) total += weight;
  const T divisor = plane_local::constant<T>(1) + over.width * total;
  for (T& weight : weights) weight = over.width * weight / divisor;
  for (std::size_t k = 0; k < 3; ++k)
    weights[face.vertices[k]] += (over.lambda[k] + over.width * over.rest[k]) / divisor;
}

// Without regard to what gradients lose.
template <class T>
void add_faces(const CageFrame& cage, const plane_local::Point<T>& local, std::span<const FaceFrame* const> near,
               std::vector<T>& weights) {
  for (const FaceFrame* face : near) {
    const plane_local::Seen<T> s = plane_local::seen(cage, *face, local);
    const plane_local::Place place = plane_local::place(s);
    if (place == plane_local::Place::on_face) {
      weights.assign(weights.size(), plane_local::constant<T>(0));
      const auto lambda = plane_local::barycentric(*face, s);
      for (std::size_t k = 0; k < 3; ++k) weights[face->vertices[k]] = lambda[k];
      return;
    }
    // In its plane a face has value 0, whatever rounding makes of its height, and a gradient: else coplanar neighbours
    // could get heights of opposite signs, and weights of ±9.
    if (place == plane_local::Place::in_plane && !plane_local::has_gradient<T>) continue;
    auto terms = plane_local::mean_value_terms(*face, s);
    if (place == plane_local::Place::in_plane)
      for (T& term : terms) term = term - plane_local::constant<T>(value_of(term));
    for (std::size_t k = 0; k < 3; ++k) weights[face->vertices[k]] += terms[k];
  }
  normalise(weights);
}

template <class T>
T part_of(const T& number) {
  return number;
}
template <class R>
R part_of(const DualOf<R>& number) {
  return number.v;
}

}  // namespace near_faces

template <class T>
void add_near_faces(const CageFrame& cage, const plane_local::Point<T>& local, std::span<const FaceFrame* const> near,
                    std::vector<T>& weights) {
  if (near.size() == 1) {
    const plane_local::Seen<T> s = plane_local::seen(cage, *near.front(), local);
    if (near_faces::is_over(s)) {
      near_faces::add_face_below(*near.front(), s, weights);
      return;
    }
  }
  if constexpr (plane_local::has_gradient<T>) {
    const Vec3 at = near_faces::values_of(local);
    if (!near.empty() && near_faces::least_distance(cage, at, near) < near_faces::quad_distance) {
      using R = typename plane_local::RealOf<T>::type;
      std::vector<R> values;
      for (const T& weight : weights) values.push_back(near_faces::part_of(weight));
      near_faces::add_faces<R>(
          cage, {near_faces::part_of(local[0]), near_faces::part_of(local[1]), near_faces::part_of(local[2])}, near,
          values);
      std::vector<T> result(weights.size());
      for (std::size_t v = 0; v < values.size(); ++v) result[v].v = values[v];
      std::vector<WideDual> sums;
      for (const T& weight : weights) sums.push_back({Quad(weight.v), Quad(weight.x), Quad(weight.y), Quad(weight.z)});
      sums = near_faces::wide_weights(cage, at, near, std::move(sums));
      for (std::size_t v = 0; v < sums.size(); ++v) near_faces::set_gradient(result[v], sums[v]);
      weights = std::move(result);
      return;
    }
  }
  near_faces::add_faces(cage, local, near, weights);
}

}  // namespace rebake
