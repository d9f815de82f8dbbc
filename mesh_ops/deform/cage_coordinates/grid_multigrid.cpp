#include "mesh_ops/deform/cage_coordinates/grid_multigrid.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

// Grids with fewer nodes than this are solved by smoothing alone.
constexpr std::size_t coarsest_nodes = 64;
constexpr int coarsest_sweeps = 60;
constexpr int max_cycles = 80;
// Relative tolerance: largest residual over the largest right side. A few rounding errors.
constexpr double converged = 3e-15;

template <class Visit>
void for_slots(std::size_t count, Visit visit) {
  constexpr std::size_t grain = 2048;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) {
    for (std::size_t k = range.begin(); k < range.end(); ++k) visit(k);
  });
}

double largest(const std::vector<GridLanes>& values) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, values.size()), 0.0,
      [&](const auto& range, double most) {
        for (std::size_t k = range.begin(); k < range.end(); ++k) most = std::max(most, values[k].abs().maxCoeff());
        return most;
      },
      [](double a, double b) { return std::max(a, b); });
}

std::array<int, 3> place_of(const GridDomain& domain, std::uint32_t node) {
  const auto nx = static_cast<std::uint32_t>(domain.size[0]), ny = static_cast<std::uint32_t>(domain.size[1]);
  return {static_cast<int>(node % nx), static_cast<int>(node / nx % ny), static_cast<int>(node / nx / ny)};
}

// The grid of every other node. Its links are twice as long, and cut if one of the two fine links is.
GridDomain coarser(const GridDomain& fine) {
  GridDomain coarse;
  for (std::size_t axis = 0; axis < 3; ++axis) coarse.size[axis] = (fine.size[axis] + 1) / 2;
  coarse.slot_of.assign(static_cast<std::size_t>(coarse.size[0]) * static_cast<std::size_t>(coarse.size[1]) *
                            static_cast<std::size_t>(coarse.size[2]),
                        GridDomain::none);
  const auto cut = [&](std::uint32_t slot, std::size_t direction) {
    const std::uint32_t row = fine.cuts_of[slot];
    return row == GridDomain::none ? 0.0 : fine.cuts[row][direction];
  };
  for (std::uint32_t slot = 0; slot < fine.node_of.size(); ++slot) {
    const std::array<int, 3> at = place_of(fine, fine.node_of[slot]);
    if (at[0] % 2 != 0 || at[1] % 2 != 0 || at[2] % 2 != 0) continue;
    GridDomain::Cuts cuts{};
    bool any = false;
    for (std::size_t direction = 0; direction < grid_directions; ++direction) {
      const double first = cut(slot, direction);
      if (first > 0) {
        cuts[direction] = first / 2;
      } else {
        const auto next = static_cast<std::ptrdiff_t>(fine.node_of[slot]) + fine.stride(direction);
        const double second = cut(fine.slot_of[static_cast<std::size_t>(next)], direction);
        if (second > 0) cuts[direction] = (1 + second) / 2;
      }
      any = any || cuts[direction] > 0;
    }
    const auto node = static_cast<std::uint32_t>((at[2] / 2 * coarse.size[1] + at[1] / 2) * coarse.size[0] + at[0] / 2);
    const auto here = static_cast<std::uint32_t>(coarse.node_of.size());
    coarse.slot_of[node] = here;
    coarse.node_of.push_back(node);
    coarse.cuts_of.push_back(any ? static_cast<std::uint32_t>(coarse.cuts.size()) : GridDomain::none);
    if (any) {
      coarse.cuts.push_back(cuts);
      coarse.cut_slots.push_back(here);
    }
  }
  return coarse;
}

}  // namespace

GridMultigrid::Level GridMultigrid::level_of(GridDomain domain) {
  Level level;
  const std::size_t count = domain.node_of.size();
  const auto zero = static_cast<std::uint32_t>(count);
  level.rows.reserve(domain.cuts.size());
  for (const GridDomain::Cuts& cuts : domain.cuts) {
    Row row{{}, 0};
    for (std::size_t low = 0; low < grid_directions; low += 2) {
      const double a = cuts[low] > 0 ? cuts[low] : 1, b = cuts[low + 1] > 0 ? cuts[low + 1] : 1;
      row.links[low] = 2 / (a * (a + b));
      row.links[low + 1] = 2 / (b * (a + b));
      row.diagonal += 2 / (a * b);
    }
    level.rows.push_back(row);
  }
  level.links.resize(count);
  for (std::uint32_t slot = 0; slot < count; ++slot) {
    const std::uint32_t row = domain.cuts_of[slot];
    for (std::size_t direction = 0; direction < grid_directions; ++direction) {
      const bool cut = row != GridDomain::none && domain.cuts[row][direction] > 0;
      const auto next = static_cast<std::ptrdiff_t>(domain.node_of[slot]) + domain.stride(direction);
      level.links[slot][direction] = cut ? zero : domain.slot_of[static_cast<std::size_t>(next)];
    }
    const std::array<int, 3> at = place_of(domain, domain.node_of[slot]);
    const auto colour = static_cast<std::size_t>((at[0] + at[1] + at[2]) % 2);
    level.colours[colour].push_back(slot);
    if (row != GridDomain::none) level.cut_colours[colour].push_back(slot);
  }
  level.values.assign(count + 1, GridLanes::Zero());
  level.right.assign(count + 1, GridLanes::Zero());
  level.residual.assign(count + 1, GridLanes::Zero());
  level.domain = std::move(domain);
  return level;
}

GridMultigrid::GridMultigrid(GridDomain domain) {
  levels_.push_back(level_of(std::move(domain)));
  while (levels_.back().domain.node_of.size() > coarsest_nodes) {
    GridDomain next = coarser(levels_.back().domain);
    if (next.node_of.empty()) break;
    levels_.push_back(level_of(std::move(next)));
  }
}

void GridMultigrid::relax(Level& level, const std::vector<std::uint32_t>& slots) {
  for_slots(slots.size(), [&](std::size_t k) {
    const std::uint32_t slot = slots[k];
    const auto& links = level.links[slot];
    GridLanes sum = level.right[slot];
    const std::uint32_t number = level.domain.cuts_of[slot];
    if (number == GridDomain::none) {
      for (const std::uint32_t link : links) sum += level.values[link];
      level.values[slot] = sum * (1.0 / 6);
    } else {
      const Row& row = level.rows[number];
      for (std::size_t d = 0; d < grid_directions; ++d) sum += row.links[d] * level.values[links[d]];
      level.values[slot] = sum / row.diagonal;
    }
  });
}

// Equations with cut links are scaled to the same diagonal as the others, since their coefficients grow without limit
// towards the surface.
void GridMultigrid::find_residual(Level& level) {
  for_slots(level.links.size(), [&](std::size_t slot) {
    const auto& links = level.links[slot];
    GridLanes sum = level.right[slot];
    const std::uint32_t number = level.domain.cuts_of[slot];
    if (number == GridDomain::none) {
      for (const std::uint32_t link : links) sum += level.values[link];
      level.residual[slot] = sum - 6 * level.values[slot];
    } else {
      const Row& row = level.rows[number];
      for (std::size_t d = 0; d < grid_directions; ++d) sum += row.links[d] * level.values[links[d]];
      level.residual[slot] = (sum - row.diagonal * level.values[slot]) * (6 / row.diagonal);
    }
  });
}

void GridMultigrid::restrict_residual(std::size_t number) {
  const Level& fine = levels_[number];
  Level& coarse = levels_[number + 1];
  for_slots(coarse.links.size(), [&](std::size_t slot) {
    const std::array<int, 3> at = place_of(coarse.domain, coarse.domain.node_of[slot]);
    GridLanes sum = GridLanes::Zero();
    const auto neighbours = [&](std::size_t axis) {
      return std::pair(std::max(-1, -2 * at[axis]), std::min(1, fine.domain.size[axis] - 1 - 2 * at[axis]));
    };
    const auto [x0, x1] = neighbours(0);
    const auto [y0, y1] = neighbours(1);
    const auto [z0, z1] = neighbours(2);
    for (int z = z0; z <= z1; ++z)
      for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
          const std::size_t node =
              (static_cast<std::size_t>(2 * at[2] + z) * static_cast<std::size_t>(fine.domain.size[1]) +
               static_cast<std::size_t>(2 * at[1] + y)) *
                  static_cast<std::size_t>(fine.domain.size[0]) +
              static_cast<std::size_t>(2 * at[0] + x);
          const std::uint32_t from = fine.domain.slot_of[node];
          if (from == GridDomain::none) continue;
          sum += fine.residual[from] * (1.0 / (8 << (std::abs(x) + std::abs(y) + std::abs(z))));
        }
    // Equations are multiplied by the step squared, which is four times as large here.
    coarse.right[slot] = sum * 4;
    coarse.values[slot].setZero();
  });
}

void GridMultigrid::add_correction(std::size_t number) {
  Level& fine = levels_[number];
  const Level& coarse = levels_[number + 1];
  for_slots(fine.links.size(), [&](std::size_t slot) {
    const std::array<int, 3> at = place_of(fine.domain, fine.domain.node_of[slot]);
    GridLanes sum = GridLanes::Zero();
    double share = 1;
    for (const int a : at) share *= a % 2 == 0 ? 1 : 0.5;
    // No inside node lies beyond the last coarse node.
    const auto last = [&](std::size_t axis) { return std::min((at[axis] + 1) / 2, coarse.domain.size[axis] - 1); };
    for (int z = at[2] / 2; z <= last(2); ++z)
      for (int y = at[1] / 2; y <= last(1); ++y)
        for (int x = at[0] / 2; x <= last(0); ++x) {
          const std::size_t node = (static_cast<std::size_t>(z) * static_cast<std::size_t>(coarse.domain.size[1]) +
                                    static_cast<std::size_t>(y)) *
                                       static_cast<std::size_t>(coarse.domain.size[0]) +
                                   static_cast<std::size_t>(x);
          const std::uint32_t from = coarse.domain.slot_of[node];
          if (from != GridDomain::none) sum += coarse.values[from];
        }
    fine.values[slot] += share * sum;
  });
}

double GridMultigrid::cycle(std::size_t number) {
  Level& level = levels_[number];
  if (number + 1 == levels_.size()) {
    for (int k = 0; k < coarsest_sweeps; ++k)
      for (const auto& colour : level.colours) relax(level, colour);
    find_residual(level);
    return largest(level.residual);
  }
  for (int k = 0; k < 2; ++k)
    for (const auto& colour : level.colours) relax(level, colour);
  find_residual(level);
  const double left = number == 0 ? largest(level.residual) : 0;
  restrict_residual(number);
  cycle(number + 1);
  // A W-cycle below the finest grid, where it costs little.
  if (number > 0) cycle(number + 1);
  add_correction(number);
  for (const auto& colour : level.cut_colours) relax(level, colour);
  for (std::size_t colour = 2; colour-- > 0;) relax(level, level.colours[colour]);
  return left;
}

const std::vector<GridLanes>& GridMultigrid::solve(const std::vector<GridLanes>& right,
                                                   const std::function<void()>& check_stop) {
  Level& finest = levels_.front();
  double scale = 0;
  for (std::size_t slot = 0; slot < right.size(); ++slot) {
    finest.right[slot] = right[slot];
    finest.values[slot].setZero();
    const std::uint32_t row = finest.domain.cuts_of[slot];
    if (row != GridDomain::none) scale = std::max(scale, right[slot].abs().maxCoeff() * 6 / finest.rows[row].diagonal);
  }
  double before = std::numeric_limits<double>::infinity();
  for (int done = 0; done < max_cycles; ++done) {
    check_stop();
    const double left = cycle(0);
    if (left <= converged * scale) return finest.values;
    // Rounding prevents further progress.
    if (left <= 100 * converged * scale && left > before / 2) return finest.values;
    before = left;
  }
  throw Error("the harmonic coordinates did not converge; try another resolution");
}

}  // namespace rebake
