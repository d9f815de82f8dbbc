#include "mesh_ops/reconstruction/grid_losses.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace rebake;

namespace {

constexpr int grid_side = 5;
constexpr double slot_count = 1000;

std::vector<GridHit> random_hits(std::size_t cells, std::size_t count) {
  std::mt19937 random(2);
  std::vector<GridHit> hits(count);
  for (GridHit& hit : hits) hit.cell = random() % 7 == 0 ? GridHit::no_cell : random() % cells;
  return hits;
}

}  // namespace

TEST(GridLosses, CellSlopesMatchDifferences) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-0.2, 1);
  std::vector<float> cells(grid_side * grid_side * grid_side);
  for (float& cell : cells) cell = static_cast<float>(unit(random));
  const std::vector<GridHit> hits = random_hits(cells.size(), 300);
  std::vector<double> shares;
  for (std::size_t h = 0; h < hits.size(); ++h) shares.push_back(unit(random));
  const auto loss = [&](const std::vector<double>& at) {
    double sum = 0, count = static_cast<double>(at.size());
    for (std::size_t h = 0; h < hits.size(); ++h)
      if (hits[h].cell != GridHit::no_cell) sum += std::max(shares[h] - at[hits[h].cell], 0.0) / slot_count;
    for (std::size_t c = 0; c < at.size(); ++c) {
      sum += 1e-5 * std::abs(at[c]) / count;
      const auto squared = [&](std::size_t other) { return 1e-5 * (at[c] - at[other]) * (at[c] - at[other]) / count; };
      if (c % grid_side + 1 < grid_side) sum += squared(c + 1);
      if (c / grid_side % grid_side + 1 < grid_side) sum += squared(c + grid_side);
      if (c / (grid_side * grid_side) + 1 < grid_side) sum += squared(c + grid_side * grid_side);
    }
    return sum;
  };
  std::vector<float> slopes(cells.size());
  add_cell_slopes(cells, grid_side, hits, shares, slot_count, slopes);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    std::vector<double> at(cells.begin(), cells.end());
    constexpr double step = 1e-6;
    at[c] += step;
    const double above = loss(at);
    at[c] -= 2 * step;
    EXPECT_NEAR(double{slopes[c]}, (above - loss(at)) / (2 * step), 1e-8);
  }
}

TEST(GridLosses, VertexSlopesMatchDifferencesOnBothSidesOfTheWall) {
  FreeGrid grid{GridSpace(CaptureKind::object, grid_side)};
  std::mt19937 random(1);
  std::uniform_real_distribution<float> offset(-0.1F, 0.1F);  // the wall is at 1/16
  for (float& value : grid.offsets) value = offset(random);
  const std::vector<GridHit> hits = random_hits(grid.space().cell_count(), 300);
  std::vector<float> slopes(grid.offsets.size());
  add_vertex_slopes(grid, hits, slot_count, slopes);
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    const double value = double{grid.offsets[i]},
                 visits = static_cast<double>(
                     std::count_if(hits.begin(), hits.end(), [&](const GridHit&hit) { return hit.cell == i / 3; }));
    const double factor = std::abs(value) > 1.0 / 16 ? 1000 : 0.01 * visits;
    EXPECT_NEAR(double{slopes[i]}, factor * 16 / grid_side * (value > 0 ? 1 : -1) / (3 * slot_count),
                1e-6 * std::abs(slopes[i]));
  }
}
