#include "editor/studies/representations/voxel_cells.h"

#include <algorithm>
#include <cmath>

namespace rebake {

namespace {

std::array<int, 3> cell_of(const VoxelCells& cells, const Vec3& point) {
  std::array<int, 3> at{};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    at[a] =
        std::clamp(static_cast<int>(std::floor((point[axis] - cells.min[axis]) / cells.voxel)), 0, cells.size[a] - 1);
  }
  return at;
}

// Which cells contain a point.
std::vector<std::uint8_t> cells_with(const std::vector<Vec3>& points, const VoxelCells& cells) {
  std::vector<std::uint8_t> met(cells.number.size(), 0);
  for (const Vec3& point : points) {
    const auto [x, y, z] = cell_of(cells, point);
    met[cells.index(x, y, z)] = 1;
  }
  return met;
}

// Calls `use` for a cell and its neighbours inside the grid.
template <class Use>
void for_neighbours(const VoxelCells& cells, int x, int y, int z, const Use& use) {
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if (x + dx >= 0 && x + dx < cells.size[0] && y + dy >= 0 && y + dy < cells.size[1] && z + dz >= 0 &&
            z + dz < cells.size[2])
          use(x + dx, y + dy, z + dz);
}

void number_cells(VoxelCells& cells, const std::vector<std::uint8_t>& met) {
  for (int z = 0; z < cells.size[2]; ++z)
    for (int y = 0; y < cells.size[1]; ++y)
      for (int x = 0; x < cells.size[0]; ++x)
        if (met[cells.index(x, y, z)] != 0)
          for_neighbours(cells, x, y, z, [&](int i, int j, int k) { cells.number[cells.index(i, j, k)] = 0; });
  for (int z = 0; z < cells.size[2]; ++z)
    for (int y = 0; y < cells.size[1]; ++y)
      for (int x = 0; x < cells.size[0]; ++x) {
        std::int32_t& number = cells.number[cells.index(x, y, z)];
        if (number < 0) continue;
        number = static_cast<std::int32_t>(cells.at.size());
        cells.at.push_back({x, y, z});
        cells.surface.push_back(met[cells.index(x, y, z)]);
      }
}

}  // namespace

std::vector<std::array<float, 3>> mean_colors(const VoxelCells& cells, const std::vector<Vec3>& points,
                                              const std::vector<std::array<float, 3>>& colors) {
  std::vector<std::array<double, 4>> sums(cells.count());
  for (std::size_t k = 0; k < points.size() && k < colors.size(); ++k) {
    const auto [x, y, z] = cell_of(cells, points[k]);
    const std::int32_t number = cells.number_at(x, y, z);
    if (number < 0) continue;
    auto& sum = sums[static_cast<std::size_t>(number)];
    for (std::size_t c = 0; c < 3; ++c) sum[c] += static_cast<double>(colors[k][c]);
    sum[3] += 1;
  }
  std::vector<std::array<float, 3>> means(cells.count(), {0.5F, 0.5F, 0.5F});
  for (std::size_t cell = 0; cell < cells.count(); ++cell) {
    std::array<double, 4> sum = sums[cell];
    const auto [x, y, z] = cells.at[cell];
    if (sum[3] == 0)
      for_neighbours(cells, x, y, z, [&](int i, int j, int k) {
        const std::int32_t number = cells.number_at(i, j, k);
        if (number < 0) return;
        for (std::size_t c = 0; c < 4; ++c) sum[c] += sums[static_cast<std::size_t>(number)][c];
      });
    if (sum[3] == 0) continue;
    for (std::size_t c = 0; c < 3; ++c) means[cell][c] = static_cast<float>(sum[c] / sum[3]);
  }
  return means;
}

VoxelCells cells_around(const std::vector<Vec3>& points, int resolution, int margin, bool cube) {
  Box bounds;
  for (const Vec3& point : points) bounds.extend(point);
  VoxelCells cells;
  cells.voxel = std::max(bounds.sizes().maxCoeff() / (resolution - 2 * margin), 1e-12);
  for (std::size_t a = 0; a < 3; ++a)
    cells.size[a] =
        cube ? resolution
             : static_cast<int>(std::ceil(bounds.sizes()[static_cast<Eigen::Index>(a)] / cells.voxel)) + 2 * margin;
  cells.min = bounds.center();
  for (std::size_t a = 0; a < 3; ++a) cells.min[static_cast<Eigen::Index>(a)] -= cells.voxel * cells.size[a] / 2;
  cells.number.assign(cells.index(0, 0, cells.size[2]), -1);
  number_cells(cells, cells_with(points, cells));
  const auto blocks = cells.blocks();
  cells.block_used.assign(
      static_cast<std::size_t>(blocks[0]) * static_cast<std::size_t>(blocks[1]) * static_cast<std::size_t>(blocks[2]),
      0);
  for (const auto& at : cells.at)
    for_neighbours(cells, at[0], at[1], at[2], [&](int x, int y, int z) {
      cells.block_used[(static_cast<std::size_t>(z / VoxelCells::block) * static_cast<std::size_t>(blocks[1]) +
                        static_cast<std::size_t>(y / VoxelCells::block)) *
                           static_cast<std::size_t>(blocks[0]) +
                       static_cast<std::size_t>(x / VoxelCells::block)] = 1;
    });
  return cells;
}

}  // namespace rebake
