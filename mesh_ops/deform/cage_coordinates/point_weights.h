#pragma once

#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <vector>

#include "mesh_ops/deform/cage_coordinates/coordinates.h"
#include "mesh_ops/deform/cage_coordinates/near_faces.h"

// Weights of one point in any number type. Only files that instantiate them include this: point_weights.cpp, and
// editor/studies/number_types.cpp for the types that only studies use.

namespace rebake {

template <class T>
double mean_value_weights(const CageFrame& cage, const Vec3& local, std::vector<T>& weights) {
  weights.assign(cage.vertices.size(), plane_local::constant<T>(0));
  const plane_local::Point<T> x = plane_local::local_point(local, T());
  std::vector<const FaceFrame*> near;
  const bool far_out = cage.is_far_out(local);
  double size = 0, sum = 0;
  for (const FaceFrame& face : cage.faces) {
    const plane_local::Seen<T> s = plane_local::seen(cage, face, x);
    if (plane_local::distance_of(s) < near_distance) {
      near.push_back(&face);
      continue;
    }
    const bool in_plane = plane_local::place(s) == plane_local::Place::in_plane;
    // In its own plane a face has value exactly 0, whatever rounding gives; its gradient is not 0.
    if (in_plane && !plane_local::has_gradient<T>) continue;
    auto terms = plane_local::mean_value_terms(face, s, far_out);
    for (std::size_t k = 0; k < 3; ++k) {
      if (in_plane) terms[k] = terms[k] - plane_local::constant<T>(value_of(terms[k]));
      weights[face.vertices[k]] += terms[k];
      size += std::abs(value_of(terms[k]));
      sum += value_of(terms[k]);
    }
  }
  const bool any_near = !near.empty();
  add_near_faces<T>(cage, x, {local.x(), local.y(), local.z()}, near, weights);
  return any_near ? 0 : size / std::abs(sum);
}

/// Barycentric coordinates of the point of a face that is nearest to the point of `s`.
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

/// Adds the near faces' terms to φ and ψ, summed per vertex before rounding.
template <class T>
void add_wide_values(const CageFrame& cage, const std::vector<std::size_t>& near_numbers,
                     const std::vector<plane_local::GreenTerms<Wide>>& terms, std::vector<T>& phi,
                     std::vector<T>& psi) {
  const Wide share = 1 / (4 * boost::math::constants::pi<Wide>());
  std::vector<Wide> of_vertices(phi.size());
  for (std::size_t n = 0; n < near_numbers.size(); ++n) {
    const std::size_t f = near_numbers[n];
    for (std::size_t k = 0; k < 3; ++k) of_vertices[cage.faces[f].vertices[k]] += terms[n].corners[k];
    psi[cage.face_numbers[f]] += plane_local::constant<T>(Wide(terms[n].face * share));
  }
  for (std::size_t v = 0; v < phi.size(); ++v) phi[v] += plane_local::constant<T>(Wide(of_vertices[v] * share));
}

/// Adds the gradients of the near faces' terms to φ and ψ, summed per vertex before rounding.
inline void add_wide_gradients(const CageFrame& cage, const std::vector<std::size_t>& near_numbers,
                               const std::vector<plane_local::GreenTerms<WideDual>>& terms, std::vector<Dual>& phi,
                               std::vector<Dual>& psi) {
  const Wide share = 1 / (4 * boost::math::constants::pi<Wide>());
  std::vector<WideDual> of_vertices(phi.size());
  const auto add_gradient = [&](Dual& to, const WideDual& from) {
    to.x += static_cast<double>(Wide(from.x * share));
    to.y += static_cast<double>(Wide(from.y * share));
    to.z += static_cast<double>(Wide(from.z * share));
  };
  for (std::size_t n = 0; n < near_numbers.size(); ++n) {
    const std::size_t f = near_numbers[n];
    for (std::size_t k = 0; k < 3; ++k) of_vertices[cage.faces[f].vertices[k]] += terms[n].corners[k];
    add_gradient(psi[cage.face_numbers[f]], terms[n].face);
  }
  for (std::size_t v = 0; v < phi.size(); ++v) add_gradient(phi[v], of_vertices[v]);
}

/// The point of the surface that is nearest to a point, in local units.
struct NearestPoint {
  double distance = std::numeric_limits<double>::infinity();
  Vec3 place;
};

/// As green_weights(), for a local point. `exact()` returns the point with 50 digits. Fills in `closest` if the point
/// is outside.
template <class T, class Exact>
bool green_weights_at(const CageFrame& cage, const Vec3& local, const Exact& exact_point, std::size_t face_count,
                      std::vector<T>& phi, std::vector<T>& psi, NearestPoint& closest) {
  phi.assign(cage.vertices.size(), plane_local::constant<T>(0));
  psi.assign(face_count, plane_local::constant<T>(0));
  const plane_local::Point<T> x = plane_local::local_point(local, T());
  const T share = plane_local::constant<T>(1 / (4 * std::numbers::pi));
  T sum = plane_local::constant<T>(0);
  double nearest = std::numeric_limits<double>::infinity();
  std::size_t nearest_face = 0;
  const auto add = [&](std::size_t f, const plane_local::GreenTerms<T>& terms) {
    for (std::size_t k = 0; k < 3; ++k) {
      phi[cage.faces[f].vertices[k]] += terms.corners[k] * share;
      sum += terms.corners[k] * share;
    }
    psi[cage.face_numbers[f]] += terms.face * share;
  };
  std::vector<const FaceFrame*> near;
  std::vector<plane_local::GreenTerms<T>> near_terms;
  std::vector<std::size_t> near_numbers;
  for (std::size_t f = 0; f < cage.faces.size(); ++f) {
    const FaceFrame& face = cage.faces[f];
    plane_local::Seen<T> s = plane_local::seen(cage, face, x);
    // Rounding must not decide on which side of its own face a point lies.
    if (plane_local::place(s) == plane_local::Place::on_face) s.h = s.h - plane_local::constant<T>(value_of(s.h));
    const auto terms = plane_local::green_terms(face, s);
    if (plane_local::distance_of(s) < near_distance) {
      near.push_back(&face);
      near_terms.push_back(terms);
      near_numbers.push_back(f);
    } else {
      add(f, terms);
    }
    if (const double distance = plane_local::distance_of(s); distance < nearest) {
      nearest = distance;
      nearest_face = f;
    }
  }
  // The sum is 0 outside and 1 inside, with other values only on the surface. If parts of the cage overlap, the winding
  // number is above 1.
  double inside = value_of(sum), winding = 0;
  bool wide = false;
  if constexpr (std::is_same_v<T, double> || std::is_same_v<T, Dual>) {
    const WidePoint exact = near.empty() ? WidePoint() : exact_point();
    if (const WideGreen of_near = wide_green(cage, exact, near); !of_near.terms.empty()) {
      wide = true;
      add_wide_values(cage, near_numbers, of_near.terms, phi, psi);
      winding = inside + of_near.sum_inside;
      inside += of_near.sum;
      sum = plane_local::constant<T>(inside);
      if constexpr (std::is_same_v<T, Dual>)
        add_wide_gradients(cage, near_numbers, wide_green_gradients(cage, exact, near), phi, psi);
    }
  }
  if (!wide) {
    for (std::size_t n = 0; n < near.size(); ++n) add(near_numbers[n], near_terms[n]);
    inside = winding = value_of(sum);
  }
  if (!(inside > 0.125 || nearest <= plane_local::surface_tolerance<T>)) {
    const FaceFrame& face = cage.faces[nearest_face];
    const auto lambda = nearest_coordinates(face, plane_local::seen(cage, face, x));
    closest = {nearest, Vec3::Zero()};
    for (std::size_t k = 0; k < 3; ++k) closest.place += value_of(lambda[k]) * cage.vertices[face.vertices[k]];
    return false;
  }
  winding = std::round(winding);
  if (winding > 1) {
    const T by_winding = plane_local::constant<T>(1 / winding);
    for (T& weight : phi) weight = weight * by_winding;
    for (T& weight : psi) weight = weight * by_winding;
    sum = sum * by_winding;
  }
  const FaceFrame& face = cage.faces[nearest_face];
  auto lambda = nearest_coordinates(face, plane_local::seen(cage, face, x));
  T missing = plane_local::constant<T>(1) - sum;
  // Gradients of 50-digit terms belong to a point inside, where the weights already sum to 1.
  if (wide) {
    missing = plane_local::constant<T>(value_of(missing));
    for (T& share_of_corner : lambda) share_of_corner = plane_local::constant<T>(value_of(share_of_corner));
  }
  for (std::size_t k = 0; k < 3; ++k) phi[face.vertices[k]] += missing * lambda[k];
  return true;
}

template <class T>
bool green_weights(const CageFrame& cage, const Vec3& point, std::size_t face_count, std::vector<T>& phi,
                   std::vector<T>& psi) {
  NearestPoint closest;
  const Vec3 local = cage.to_local(point);
  if (green_weights_at(
          cage, local, [&] { return wide_local_point(cage, point); }, face_count, phi, psi, closest))
    return true;
  // Far from the origin, a point on the surface may lie outside by the rounding of its coordinates.
  if (!(closest.distance <= cage.surface_tolerance)) return false;
  const Vec3 on = closest.place;
  const auto exact = [&] { return WidePoint{Wide(on.x()), Wide(on.y()), Wide(on.z())}; };
  return green_weights_at(cage, on, exact, face_count, phi, psi, closest);
}

}  // namespace rebake
