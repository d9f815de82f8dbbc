#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace rebake {

/// Number of functions that are solved together (SIMD lanes).
constexpr std::size_t grid_lanes = 8;
using GridLanes = Eigen::Array<double, grid_lanes, 1>;

/// The six directions along a grid's axes: −x, +x, −y, +y, −z, +z.
constexpr std::size_t grid_directions = 6;

/// Nodes of a regular grid that lie inside a surface ("slots"), and their distances from it along grid lines.
struct GridDomain {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  /// Per direction: distance in steps, in (0, 1], at which the link to the neighbour intersects the surface; 0 if the
  /// link leads to an inside node.
  using Cuts = std::array<double, grid_directions>;

  std::array<int, 3> size{};           ///< nodes along x, y, z; x runs fastest
  std::vector<std::uint32_t> slot_of;  ///< per node: its number among inside nodes, or none
  std::vector<std::uint32_t> node_of;  ///< per slot: its node number; ascending
  std::vector<std::uint32_t> cuts_of;  ///< per slot: its row of `cuts`, or none if no link is cut
  std::vector<Cuts> cuts;
  std::vector<std::uint32_t> cut_slots;  ///< per row of `cuts`: its slot; ascending

  /// Offset in node numbers to the neighbour in a direction.
  std::ptrdiff_t stride(std::size_t direction) const {
    const std::ptrdiff_t along[] = {1, size[0], static_cast<std::ptrdiff_t>(size[0]) * size[1]};
    return direction % 2 == 0 ? -along[direction / 2] : along[direction / 2];
  }
};

/// Solver of Laplace's equation in a GridDomain, by the finite differences of Shortley and Weller (1938): of second
/// order up to the surface, and exact for quadratic functions. Multigrid with red-black Gauss-Seidel smoothing
/// (Trottenberg, Oosterlee, Schüller 2001); coarser grids have every other node and the same surface. Results do not
/// depend on the number of threads.
class GridMultigrid {
 public:
  explicit GridMultigrid(GridDomain domain);

  const GridDomain& domain() const { return levels_.front().domain; }
  /// Coefficient of the surface value of a cut link in its node's equation; the right side is the sum of coefficients
  /// times values. `row`: a row of domain().cuts.
  double surface_coefficient(std::size_t row, std::size_t direction) const {
    return levels_.front().rows[row].links[direction];
  }
  /// Solves the equations for the right sides `right`, one entry per slot. The result has one entry per slot and a zero
  /// at the end. `check_stop` is called once per cycle and may throw. Throws Error if it does not converge (not
  /// observed for any closed surface).
  const std::vector<GridLanes>& solve(const std::vector<GridLanes>& right, const std::function<void()>& check_stop);

 private:
  /// The equation of a slot with cut links.
  struct Row {
    std::array<double, grid_directions> links;  ///< coefficients of the six links
    double diagonal;
  };
  struct Level {
    GridDomain domain;
    std::vector<Row> rows;  ///< per row of domain.cuts
    /// Per slot: slots of its neighbours; cut links lead to the zero after the last slot.
    std::vector<std::array<std::uint32_t, grid_directions>> links;
    /// Slots by checkerboard colour; `cut_colours` has only those with cut links.
    std::array<std::vector<std::uint32_t>, 2> colours, cut_colours;
    std::vector<GridLanes> values, right, residual;  ///< per slot, and a zero after the last
  };
  static Level level_of(GridDomain domain);
  static void relax(Level& level, const std::vector<std::uint32_t>& slots);
  static void find_residual(Level& level);
  void restrict_residual(std::size_t level);
  void add_correction(std::size_t level);
  /// One multigrid cycle from a level down. Returns the largest residual before the coarse-grid correction.
  double cycle(std::size_t level);

  std::vector<Level> levels_;
};

}  // namespace rebake
