#pragma once

#include <vector>

#include "mesh_ops/deform/cage_coordinates/coordinates.h"

namespace rebake::test {

struct CoordinateErrors {
  double sum = 0;     ///< largest deviation of the sum of weights from 1
  double linear = 0;  ///< largest distance of the weighted cage vertices from the point, in cage diagonals
};

/// Largest errors over the points; expects that all of them are inside.
CoordinateErrors errors_of(const Coordinates& coordinates, const Cage& cage, const std::vector<Vec3>& points);

/// Weights of one point by a SIMD batch of equal points, per row. Appends a gradient per row to `gradients` if not
/// null.
std::vector<double> weights_at(const Coordinates& coordinates, const Vec3& point,
                               std::vector<Vec3>* gradients = nullptr);

}  // namespace rebake::test
