#pragma once

#include <vector>

#include "mesh_ops/deform/cage.h"

namespace rebake {

/// A cage that turns rigidly, and points that are hard to weigh: on its edges, one rounding beside them, and 1e-8 of
/// its size off its corners. Where the points go is known exactly.
struct HardPoints {
  Cage cage;
  std::vector<Vec3> moved;   ///< the cage's points, turned
  std::vector<Vec3> points;  ///< in the cage, on it, or one rounding outside
  Mat3 turn;                 ///< by right angles, so that nothing is rounded
};

/// A wedge with an edge of slope 0.01 and a box of 3 × 3 × 3 cells.
std::vector<HardPoints> hard_points();

/// Of points that coordinates give as moved: the largest error, in units of the cage's size. `outside` points (not
/// weighed) are left out; null: there are none.
double largest_error(const HardPoints& hard, const std::vector<Vec3>& moved, const std::vector<std::uint8_t>* outside);

}  // namespace rebake
