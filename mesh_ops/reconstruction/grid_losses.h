#pragma once

#include "mesh_ops/reconstruction/free_grid.h"

namespace rebake {

// Derivatives of the losses on the grid itself (MobileNeRF, published code). `slots`: rays of a step times the most
// hits of a ray, by which sums over hits are divided.

/// Acceleration grid: mean over slots of max(share − value, 0), so that a cell rises to the largest share of a ray's
/// colour that comes from it, + 1e-5 · mean |value| + 1e-5 · the mean of the squared differences between neighbours
/// (per cell, each pair once). `shares`: per hit. Adds to `slopes`, one per cell.
void add_cell_slopes(const std::vector<float>& cells, int side, const std::vector<GridHit>& hits,
                     const std::vector<double>& shares, double slots, std::vector<float>& slopes);

/// Vertices: mean over slots and axes of 0.01 · |offset| for the vertex of each hit's cell, and of 1000 · |offset| for
/// vertices outside the middle half of their cells. Offsets in units of half the grid's size. Adds to `slopes`, as
/// FreeGrid::offsets.
void add_vertex_slopes(const FreeGrid& grid, const std::vector<GridHit>& hits, double slots,
                       std::vector<float>& slopes);

}  // namespace rebake
