#pragma once

#include <span>
#include <vector>

#include "mesh_ops/deform/plane_local.h"

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

}  // namespace rebake
