#pragma once

#include <vector>

#include "mesh_ops/deform/cages/cage_mesh.h"

namespace rebake {

/// Worst case for cage coordinates: a rigidly rotated cage, and points with ill-conditioned weights. They lie on edges,
/// one rounding error beside edges, and 1e-8 of the cage's size from corners. Their exact positions after the rotation
/// are known.
struct HardPoints {
  Cage cage;
  std::vector<Vec3> moved;   ///< rotated vertices of the cage
  std::vector<Vec3> points;  ///< inside the cage, on it, or one rounding error outside
  Mat3 turn;                 ///< the rotation; by 90°, so that nothing is rounded
};

/// Two cases: a thin wedge whose sides have a slope of 0.01, and a box of 3 × 3 × 3 cells.
std::vector<HardPoints> hard_points();

/// Largest error of computed positions `moved`, as a share of the cage's size. `outside`: 1 for points that the
/// coordinates do not reach, which are ignored; null for none.
double largest_error(const HardPoints& hard, const std::vector<Vec3>& moved, const std::vector<std::uint8_t>* outside);

}  // namespace rebake
