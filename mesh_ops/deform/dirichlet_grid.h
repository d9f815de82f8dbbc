#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/deform/cage.h"
#include "mesh_ops/deform/grid_multigrid.h"

namespace rebake {

/// A point of a cage's surface: a face's corners, weighted (barycentric coordinates).
struct SurfacePoint {
  std::uint32_t face;
  std::array<double, 3> corners;
};

/// Functions that are harmonic inside a closed surface and have given values on it, on a regular grid. Nodes inside
/// solve Laplace's equation (see GridMultigrid); those outside that cells of inside points use continue the function
/// linearly from the surface. Values inside and up to the surface are right to second order in the step; linear
/// functions are exact everywhere. Where two parts of the surface lie less than a step apart, points between the last
/// nodes take from both.
class DirichletGrid {
 public:
  /// `resolution` cells along the longest side of the surface's box.
  DirichletGrid(const Cage& surface, int resolution, const Progress& progress = {});

  /// Where values are asked for.
  const std::vector<SurfacePoint>& surface() const { return surface_; }
  /// Nodes inside and those outside that cells of inside points use.
  std::size_t nodes() const { return inside_nodes() + outer_.size(); }
  /// `surface_values` one a point of surface(), `values` one a node. Those of lonely() nodes are zero.
  /// `check_stop` is called now and then, and may throw.
  void solve(
      const std::vector<GridLanes>& surface_values, std::vector<GridLanes>& values,
      const std::function<void()>& check_stop = [] {});

  /// Of the nodes, how many lie inside: the first ones. The others' values are continued.
  std::size_t inside_nodes() const { return multigrid_->domain().node_of.size(); }
  /// Nodes outside that have too few inside beside them to continue from, as in spikes thinner than a step.
  const std::vector<std::size_t>& lonely() const { return lonely_; }
  Vec3 place(std::size_t node) const;

  struct Cell {
    std::array<std::uint32_t, 8> nodes;  ///< x runs fastest
    Vec3 at;                             ///< 0 … 1 within it
  };
  double step() const { return step_; }
  /// The cell that a point lies in; false where it is outside, more than a cell from the surface.
  bool find_cell(const Vec3& point, Cell& cell) const;

 private:
  struct Outer {
    std::uint32_t node;
    std::uint32_t foot;  ///< the nearest point of the surface
    Vec3 foot_place;     ///< in steps
  };
  struct Term {
    std::uint32_t source;  ///< a slot inside; beyond those a point of the surface
    double coefficient;
  };

  std::size_t number(int x, int y, int z) const;
  Vec3 place_of(std::size_t node) const;  ///< in steps
  void find_distances(const std::vector<Vec3>& vertices, const std::vector<Face>& faces, const Progress& progress);
  std::vector<std::uint8_t> find_inside(const std::vector<Vec3>& vertices, const std::vector<Face>& faces,
                                        const Progress& progress) const;
  void cut_links(GridDomain& domain, const std::vector<Vec3>& vertices, const std::vector<Face>& faces,
                 const Progress& progress);
  void continue_outwards(const std::vector<Vec3>& vertices, const std::vector<Face>& faces, const Progress& progress);
  std::vector<Term> continuation(const Outer& outer, double reach, const std::vector<Vec3>& surface_places) const;

  double step_ = 0;
  Vec3 origin_;
  std::array<int, 3> size_{};
  std::vector<float> distance_;         ///< of every node near the surface from it, in steps
  std::vector<std::uint32_t> nearest_;  ///< face of the surface, or none
  std::vector<SurfacePoint> surface_;
  std::vector<std::array<std::uint32_t, grid_directions>> cut_points_;  ///< beside the domain's cuts
  std::vector<Outer> outer_;
  std::vector<std::uint32_t> outer_of_;  ///< of every node its place in outer_, or none
  std::vector<std::size_t> first_term_;  ///< of every outer node, and one more
  std::vector<Term> terms_;
  std::vector<std::size_t> lonely_;
  std::unique_ptr<GridMultigrid> multigrid_;
};

}  // namespace rebake
