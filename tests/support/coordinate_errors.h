#pragma once

#include <vector>

#include "mesh_ops/deform/coordinates.h"

namespace rebake::test {

struct CoordinateErrors {
  double sum = 0;     ///< of weights, from 1
  double linear = 0;  ///< of weighted cage points, from the point, in diagonals of the cage
};

/// The largest over points, all of which must be inside.
CoordinateErrors errors_of(const Coordinates& coordinates, const Cage& cage, const std::vector<Vec3>& points);

/// Weights of single points through the batch, which passes delicate ones on. `gradients`: one a row is appended.
std::vector<double> weights_at(const Coordinates& coordinates, const Vec3& point,
                               std::vector<Vec3>* gradients = nullptr);

}  // namespace rebake::test
