#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/deform/cage_coordinates/grid_multigrid.h"
#include "mesh_ops/deform/cages/cage_mesh.h"

namespace rebake {

/// A point of a cage's surface: a face, and barycentric coordinates at its corners.
struct SurfacePoint {
  std::uint32_t face;
  std::array<double, 3> corners;
};

/// Solver of the Dirichlet problem on a regular grid: functions that are harmonic inside a closed surface and have
/// given values on it. Inside nodes solve Laplace's equation (see GridMultigrid). Outer nodes are the outside nodes of
/// cells that contain inside points; their values are extrapolated linearly from the surface. Errors are of second
/// order in the step, inside and up to the surface; linear functions are exact. If two parts of the surface lie less
/// than a step apart, points between the outermost nodes mix values of both.
class DirichletGrid {
 public:
  /// `resolution`: cells along the longest side of the surface's box.
  DirichletGrid(const Cage& surface, int resolution, const Progress& progress = {});

  /// Points at which solve() needs surface values.
  const std::vector<SurfacePoint>& surface() const { return surface_; }
  /// Number of inside and outer nodes.
  std::size_t nodes() const { return inside_nodes() + outer_.size(); }
  /// Solves for grid_lanes functions together. `surface_values`: one entry per point of surface(). `values` receives
  /// one entry per node, zero for lonely() nodes. `check_stop` is called once per multigrid cycle and may throw. Throws
  /// Error if the solver does not converge.
  void solve(
      const std::vector<GridLanes>& surface_values, std::vector<GridLanes>& values,
      const std::function<void()>& check_stop = [] {});

  /// Number of inside nodes. They come first; outer nodes follow.
  std::size_t inside_nodes() const { return multigrid_->domain().node_of.size(); }
  /// Outer nodes with too few inside nodes near them to extrapolate from, as in spikes thinner than a step.
  const std::vector<std::size_t>& isolated_nodes() const { return isolated_nodes_; }
  /// Position of an inside or outer node.
  Vec3 place(std::size_t node) const;

  struct Cell {
    std::array<std::uint32_t, 8> nodes;  ///< node numbers of the corners; x runs fastest
    Vec3 at;                             ///< position within the cell, 0 … 1 per axis
  };
  double step() const { return step_; }
  /// Finds the cell that contains a point. Returns false if the point is outside, more than a cell from the surface.
  bool find_cell(const Vec3& point, Cell& cell) const;

 private:
  /// An outer node.
  struct OuterNode {
    std::uint32_t node;
    std::uint32_t foot;  ///< nearest point of the surface: index in surface()
    Vec3 foot_place;     ///< position of that point, in steps
  };
  /// A summand of an extrapolated value.
  struct Term {
    std::uint32_t source;  ///< slot of an inside node, or inside_nodes() + index in surface()
    double coefficient;
  };

  std::size_t number(int x, int y, int z) const;
  Vec3 place_of(std::size_t node) const;  ///< position in steps, from the first node
  void find_distances(const std::vector<Vec3>& vertices, const std::vector<Face>& faces, const Progress& progress);
  std::vector<std::uint8_t> find_inside(const std::vector<Vec3>& vertices, const std::vector<Face>& faces,
                                        const Progress& progress) const;
  /// Where the surface cuts the link from a node towards a neighbour, as a share of its length.
  struct LinkCut {
    std::size_t node;
    std::size_t direction;
    double share;
    SurfacePoint point;
  };
  std::vector<LinkCut> line_cuts(const GridDomain& domain, const std::vector<Vec3>& vertices,
                                 const std::vector<Face>& faces, const Progress& progress) const;
  std::vector<std::uint8_t> add_missed_cuts(const GridDomain& domain, const std::vector<Vec3>& vertices,
                                            const std::vector<Face>& faces, std::vector<LinkCut>& hits) const;
  void cut_links(GridDomain& domain, const std::vector<Vec3>& vertices, const std::vector<Face>& faces,
                 const Progress& progress);
  void extrapolate_outwards(const std::vector<Vec3>& vertices, const std::vector<Face>& faces,
                            const Progress& progress);
  std::vector<Term> extrapolation_terms(const OuterNode& outer, double reach,
                                        const std::vector<Vec3>& surface_places) const;

  double step_ = 0;
  Vec3 origin_;
  std::array<int, 3> size_{};
  std::vector<float> distance_;         ///< per node: distance from the surface in steps; infinite beyond 1.75
  std::vector<std::uint32_t> nearest_;  ///< per node: nearest face of the surface, or none
  std::vector<SurfacePoint> surface_;
  /// Per row of the domain's `cuts` and direction: index in surface_, or none.
  std::vector<std::array<std::uint32_t, grid_directions>> cut_points_;
  std::vector<OuterNode> outer_;
  std::vector<std::uint32_t> outer_index_;  ///< per node: index in outer_, or none
  std::vector<std::size_t> first_term_;     ///< per outer node: its first entry in terms_; one more at the end
  std::vector<Term> terms_;
  std::vector<std::size_t> isolated_nodes_;
  std::unique_ptr<GridMultigrid> multigrid_;
};

}  // namespace rebake
