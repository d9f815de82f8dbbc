#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// A regular grid of cubes of which some are occupied: the cells that are fitted.
struct VoxelCells {
  std::array<int, 3> size{};
  Vec3 min = Vec3::Zero();
  double voxel = 0;                      ///< side of a cell in scene units
  std::vector<std::int32_t> number;      ///< per cell, x fastest: its number among the occupied ones; −1: empty
  std::vector<std::uint8_t> surface;     ///< per occupied cell: whether a surface passes through it
  std::vector<std::array<int, 3>> at;    ///< per occupied cell
  std::vector<std::uint8_t> block_used;  ///< per block of block³ cells: whether it, or a cell beside it, is occupied
  static constexpr int block = 8;

  std::size_t count() const { return at.size(); }
  std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size[0]) +
           static_cast<std::size_t>(x);
  }
  std::int32_t number_at(int x, int y, int z) const {
    return x < 0 || y < 0 || z < 0 || x >= size[0] || y >= size[1] || z >= size[2] ? -1 : number[index(x, y, z)];
  }
  std::array<int, 3> blocks() const {
    return {(size[0] + block - 1) / block, (size[1] + block - 1) / block, (size[2] + block - 1) / block};
  }
};

/// Mean colour of the points in each occupied cell, from the cells beside it if it has none; `colors`: of the points.
std::vector<std::array<float, 3>> mean_colors(const VoxelCells& cells, const std::vector<Vec3>& points,
                                              const std::vector<std::array<float, 3>>& colors);

/// Cells around points of surfaces, in a grid with `resolution` cells along the longest side of their bounds and
/// `margin` cells around them. A cell is occupied if it, or one of its 26 neighbours, contains a point. `cube`: the
/// grid has `resolution` cells along every side.
VoxelCells cells_around(const std::vector<Vec3>& points, int resolution, int margin, bool cube);

}  // namespace rebake
