#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <vector>

#include "mesh_ops/deform/cage_coordinates/coordinates.h"

// Weights of many points, in blocks of batch_lanes.

namespace rebake {

/// Number of blocks of batch_lanes points.
inline std::size_t blocks_of(std::size_t points) { return (points + batch_lanes - 1) / batch_lanes; }

/// The points of one block; the last point is repeated to fill it.
inline std::array<Vec3, batch_lanes> block_points(const std::vector<Vec3>& points,
                                                  const std::vector<std::uint32_t>& order, std::size_t block) {
  std::array<Vec3, batch_lanes> result;
  for (std::size_t lane = 0; lane < batch_lanes; ++lane)
    result[lane] = points[order[std::min(block * batch_lanes + lane, order.size() - 1)]];
  return result;
}

/// Calls visit(block, weights, gradients, outside) for every block, in parallel. Layouts as in Coordinates::weigh();
/// `gradients` is empty if not requested.
template <class Visit>
void for_blocks(const Coordinates& coordinates, const std::vector<Vec3>& points,
                const std::vector<std::uint32_t>& order, bool gradients, const Progress& progress, Visit visit) {
  const std::size_t blocks = blocks_of(order.size());
  std::atomic<std::size_t> done = 0;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 64), [&](const auto& range) {
    std::vector<double> weights(coordinates.rows() * batch_lanes);
    std::vector<double> slopes(gradients ? coordinates.rows() * 3 * batch_lanes : 0);
    std::array<std::uint8_t, batch_lanes> outside;
    for (std::size_t block = range.begin(); block < range.end(); ++block) {
      coordinates.compute_weights(block_points(points, order, block), weights.data(),
                                  gradients ? slopes.data() : nullptr, outside.data());
      visit(block, weights, slopes, outside);
    }
    progress.at("cage weights", static_cast<double>(done += range.size()) / static_cast<double>(blocks));
  });
}

/// Rows with a motion other than zero, and their motions (x, y, z per row).
struct MovingRows {
  std::vector<std::uint32_t> rows;
  std::vector<float> motions;
};
inline MovingRows moving_rows(const std::vector<Vec3>& motions) {
  MovingRows moving;
  for (std::uint32_t row = 0; row < motions.size(); ++row) {
    if (motions[row].isZero(0)) continue;
    moving.rows.push_back(row);
    for (int axis = 0; axis < 3; ++axis) moving.motions.push_back(static_cast<float>(motions[row][axis]));
  }
  return moving;
}

}  // namespace rebake
