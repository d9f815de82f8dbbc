#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace rebake {

/// How many functions are solved for at once.
constexpr std::size_t grid_lanes = 8;
using GridLanes = Eigen::Array<double, grid_lanes, 1>;

/// The six directions along a grid's axes: −x, +x, −y, +y, −z, +z.
constexpr std::size_t grid_directions = 6;

/// The nodes of a regular grid that lie inside a surface, and how far they are from it along the grid's lines.
struct GridDomain {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  /// Distances in steps, in (0, 1], where a link to a neighbour meets the surface; 0 where it leads to a node inside.
  using Cuts = std::array<double, grid_directions>;

  std::array<int, 3> size{};           ///< nodes along x, y, z; x runs fastest
  std::vector<std::uint32_t> slot_of;  ///< of every node its number among those inside, or none
  std::vector<std::uint32_t> node_of;  ///< of every slot; ascending
  std::vector<std::uint32_t> cuts_of;  ///< of every slot its row of `cuts`, or none where no link is cut
  std::vector<Cuts> cuts;
  std::vector<std::uint32_t> cut_slots;  ///< of every row of `cuts`; ascending

  /// How far apart neighbours in a direction lie among the nodes.
  std::ptrdiff_t stride(std::size_t direction) const {
    const std::ptrdiff_t along[] = {1, size[0], static_cast<std::ptrdiff_t>(size[0]) * size[1]};
    return direction % 2 == 0 ? -along[direction / 2] : along[direction / 2];
  }
};

/// Laplace's equation in a GridDomain by the differences of Shortley and Weller (1938): of second order up to the
/// surface, and exact for quadratic functions. Solved by multigrid with red-black Gauss-Seidel (Trottenberg, Oosterlee,
/// Schüller 2001), whose coarser grids take every other node and the same surface. Results do not depend on the number
/// of threads.
class GridMultigrid {
 public:
  explicit GridMultigrid(GridDomain domain);

  const GridDomain& domain() const { return levels_.front().domain; }
  /// Coefficient of a cut link's surface value in its node's equation, whose right side is the sum of these times the
  /// values. `row` of domain().cuts.
  double surface_coefficient(std::size_t row, std::size_t direction) const {
    return levels_.front().rows[row].links[direction];
  }
  /// `right` and the result: one a slot. `check_stop` is called now and then, and may throw. Throws Error where it does
  /// not converge, which no closed surface has shown.
  const std::vector<GridLanes>& solve(const std::vector<GridLanes>& right, const std::function<void()>& check_stop);

 private:
  struct Row {
    std::array<double, grid_directions> links;  ///< coefficients, of cut links too
    double diagonal;
  };
  struct Level {
    GridDomain domain;
    std::vector<Row> rows;                                           ///< beside domain.cuts
    std::vector<std::array<std::uint32_t, grid_directions>> links;   ///< slots; the last slot's next: always zero
    std::array<std::vector<std::uint32_t>, 2> colours, cut_colours;  ///< slots, as on a checkerboard; those cut
    std::vector<GridLanes> values, right, residual;                  ///< one a slot and a zero after them
  };
  static Level level_of(GridDomain domain);
  static void relax(Level& level, const std::vector<std::uint32_t>& slots);
  static void find_residual(Level& level);
  void restrict_residual(std::size_t level);
  void add_correction(std::size_t level);
  /// The largest residual before the correction by the coarser grid.
  double cycle(std::size_t level);

  std::vector<Level> levels_;
};

}  // namespace rebake
