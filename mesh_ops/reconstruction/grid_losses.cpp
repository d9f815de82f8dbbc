#include "mesh_ops/reconstruction/grid_losses.h"

#include <tbb/parallel_for.h>

#include <cmath>

namespace rebake {

void add_cell_slopes(const std::vector<float>& cells, int side, const std::vector<GridHit>& hits,
                     const std::vector<double>& shares, double slots, std::vector<float>& slopes) {
  for (std::size_t h = 0; h < hits.size(); ++h)
    if (const std::uint32_t cell = hits[h].cell; cell != GridHit::no_cell && shares[h] > double{cells[cell]})
      slopes[cell] -= static_cast<float>(1 / slots);
  const auto row = static_cast<std::size_t>(side), layer = row * row;
  const auto scale = static_cast<float>(1e-5 / static_cast<double>(cells.size()));
  tbb::parallel_for(std::size_t{0}, row, [&](std::size_t z) {
    for (std::size_t cell = z * layer; cell < (z + 1) * layer; ++cell) {
      const float value = cells[cell];
      float slope = value > 0 ? 1.0F : value < 0 ? -1.0F : 0.0F;
      const std::size_t x = cell % row, y = cell / row % row;
      if (x > 0) slope += 2 * (value - cells[cell - 1]);
      if (x + 1 < row) slope += 2 * (value - cells[cell + 1]);
      if (y > 0) slope += 2 * (value - cells[cell - row]);
      if (y + 1 < row) slope += 2 * (value - cells[cell + row]);
      if (z > 0) slope += 2 * (value - cells[cell - layer]);
      if (z + 1 < row) slope += 2 * (value - cells[cell + layer]);
      slopes[cell] += scale * slope;
    }
  });
}

void add_vertex_slopes(const FreeGrid& grid, const std::vector<GridHit>& hits, double slots,
                       std::vector<float>& slopes) {
  constexpr double weak = 0.01, wall = 1000;
  constexpr auto half_cell = static_cast<float>(0.5 / FreeGrid::offset_cells);
  const double unit = 2 * FreeGrid::offset_cells / grid.space().side() / (3 * slots);
  for (const GridHit& hit : hits) {
    if (hit.cell == GridHit::no_cell) continue;
    for (std::size_t i = 3 * std::size_t{hit.cell}; i < 3 * std::size_t{hit.cell} + 3; ++i)
      if (const float offset = grid.offsets[i]; offset != 0 && std::abs(offset) <= half_cell)
        slopes[i] += static_cast<float>(std::copysign(weak * unit, offset));
  }
  for (std::size_t i = 0; i < grid.offsets.size(); ++i)
    if (const float offset = grid.offsets[i]; std::abs(offset) > half_cell)
      slopes[i] += static_cast<float>(std::copysign(wall * unit, offset));
}

}  // namespace rebake
