#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "mesh_ops/deform/coordinates.h"
#include "mesh_ops/deform/near_faces.h"

// The weights of one point in any number type, for the files that instantiate them: point_weights.cpp, and
// editor/studies/number_types.cpp what only studies compare with.

namespace rebake {

template <class T>
void mean_value_weights(const CageFrame& cage, const Vec3& local, std::vector<T>& weights) {
  weights.assign(cage.vertices.size(), plane_local::constant<T>(0));
  const plane_local::Point<T> x = plane_local::local_point(local, T());
  std::vector<const FaceFrame*> near;
  for (const FaceFrame& face : cage.faces) {
    const plane_local::Seen<T> s = plane_local::seen(cage, face, x);
    if (distance_of(s) < near_distance) {
      near.push_back(&face);
      continue;
    }
    const bool in_plane = plane_local::place(s) == plane_local::Place::in_plane;
    // Of a face's value rounding must not decide where it is 0; its gradient is not.
    if (in_plane && !plane_local::has_gradient<T>) continue;
    auto terms = plane_local::mean_value_terms(face, s);
    for (std::size_t k = 0; k < 3; ++k) {
      if (in_plane) terms[k] = terms[k] - plane_local::constant<T>(value_of(terms[k]));
      weights[face.vertices[k]] += terms[k];
    }
  }
  add_near_faces<T>(cage, x, near, weights);
}

/// The nearest point of a face to what `s` sees, as barycentric coordinates.
template <class T>
std::array<T, 3> nearest_coordinates(const FaceFrame& face, const plane_local::Seen<T>& s) {
  const bool inside = value_of(s.a[0]) >= 0 && value_of(s.a[1]) >= 0 && value_of(s.a[2]) >= 0;
  if (inside) return plane_local::barycentric(face, s);
  double least = std::numeric_limits<double>::infinity();
  std::array<T, 3> result;
  for (std::size_t k = 0; k < 3; ++k) {
    const double begin = value_of(s.begin[k]), end = value_of(s.end[k]);
    const double distance = std::hypot(value_of(s.c[k]), std::max({0.0, begin, -end}));
    if (distance >= least) continue;
    least = distance;
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    result[k] = plane_local::constant<T>(0);
    result[j] = begin >= 0 ? plane_local::constant<T>(0)
                : end <= 0 ? plane_local::constant<T>(1)
                           : T(-s.begin[k] / plane_local::constant<T>(face.lengths[k]));
    result[i] = plane_local::constant<T>(1) - result[j];
  }
  return result;
}

template <class T>
bool green_weights(const CageFrame& cage, const Vec3& local, std::size_t face_count, std::vector<T>& phi,
                   std::vector<T>& psi) {
  phi.assign(cage.vertices.size(), plane_local::constant<T>(0));
  psi.assign(face_count, plane_local::constant<T>(0));
  const plane_local::Point<T> x = plane_local::local_point(local, T());
  const T share = plane_local::constant<T>(1 / (4 * std::numbers::pi));
  T sum = plane_local::constant<T>(0);
  double nearest = std::numeric_limits<double>::infinity(), extent = 0;
  std::size_t nearest_face = 0;
  const auto add = [&](std::size_t f, const plane_local::GreenTerms<T>& terms) {
    for (std::size_t k = 0; k < 3; ++k) {
      phi[cage.faces[f].vertices[k]] += terms.corners[k] * share;
      sum += terms.corners[k] * share;
    }
    psi[cage.face_numbers[f]] = terms.face * share;
  };
  std::vector<const FaceFrame*> near;
  std::vector<plane_local::GreenTerms<T>> near_terms;
  std::vector<std::size_t> near_numbers;
  for (std::size_t f = 0; f < cage.faces.size(); ++f) {
    const FaceFrame& face = cage.faces[f];
    plane_local::Seen<T> s = plane_local::seen(cage, face, x);
    // Rounding must not decide which side of its own face a point lies on.
    if (plane_local::place(s) == plane_local::Place::on_face) s.h = s.h - plane_local::constant<T>(value_of(s.h));
    const auto terms = plane_local::green_terms(face, s);
    if (distance_of(s) < near_distance) {
      near.push_back(&face);
      near_terms.push_back(terms);
      near_numbers.push_back(f);
    } else {
      add(f, terms);
    }
    const double distance = std::hypot(value_of(s.h), plane_local::distance_in_plane(s));
    extent = std::max(extent, s.far);
    if (distance < nearest) {
      nearest = distance;
      nearest_face = f;
    }
  }
  bool mended = false;
  if constexpr (std::is_same_v<T, Dual>) mended = mend_gradients(cage, x, near, near_terms);
  for (std::size_t n = 0; n < near.size(); ++n) add(near_numbers[n], near_terms[n]);
  // Outside the sum is 0, inside 1; between them only on the surface.
  if (!(value_of(sum) > 0.125 || nearest <= 4 * plane_local::epsilon<T> * extent)) return false;
  const FaceFrame& face = cage.faces[nearest_face];
  auto lambda = nearest_coordinates(face, plane_local::seen(cage, face, x));
  // Mended gradients are those of a place where nothing is missing.
  if (mended)
    for (T& share_of_corner : lambda) share_of_corner = plane_local::constant<T>(value_of(share_of_corner));
  const T missing = plane_local::constant<T>(1) - sum;
  for (std::size_t k = 0; k < 3; ++k) phi[face.vertices[k]] += missing * lambda[k];
  return true;
}

}  // namespace rebake
