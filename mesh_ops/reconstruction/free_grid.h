#pragma once

#include <vector>

#include "mesh_ops/reconstruction/grid_space.h"

namespace rebake {

/// A quad of the grid: the vertices of 2 × 2 neighbouring cells of a layer.
struct GridQuad {
  int axis;                  ///< normal of the layer
  std::array<int, 3> first;  ///< the cell with the least coordinates

  /// The cells of its vertices: `first`, and the neighbours along the first, the second and both in-plane axes.
  std::array<std::array<int, 3>, 4> cells() const;
};
/// The vertices of a quad's two triangles, as indices into GridQuad::cells().
inline constexpr std::array<std::array<int, 3>, 2> quad_triangles{{{0, 1, 3}, {0, 3, 2}}};

/// A vertex per cell, which is free to move, and between them a quad per pair of neighbouring cells (MobileNeRF,
/// section 3.1).
class FreeGrid {
 public:
  /// All vertices are at the centres of their cells.
  explicit FreeGrid(const GridSpace& space);

  const GridSpace& space() const { return space_; }
  /// [cell][axis]: a vertex lies at offset · offset_cells cells from the centre of its cell. The factor makes the steps
  /// of an optimiser, in cells, independent of the grid's side.
  std::vector<float> offsets;
  static constexpr double offset_cells = 8;

  /// Cell coordinates of a vertex, by its offset.
  Vec3 cells_of(std::uint32_t cell) const;
  /// Computes the positions from the offsets. To be called after these change.
  void place_vertices();
  /// Vertex positions in the normalised frame.
  const std::vector<Vec3>& positions() const { return positions_; }
  /// Writes to `slopes` (as `offsets`) the derivatives by offsets for derivatives by positions.
  void offset_slopes(const std::vector<Vec3>& position_slopes, std::vector<float>& slopes) const;

 private:
  GridSpace space_;
  std::vector<Vec3> positions_;
};

/// An intersection of a ray with the grid's triangles.
struct GridHit {
  static constexpr std::uint32_t no_cell = 0xffffffff;
  double t = 0;                            ///< the hit is at origin + t · direction
  std::uint32_t cell = no_cell;            ///< the cell in which it lies; no_cell: on a nested box
  std::array<std::uint32_t, 3> corners{};  ///< cells of the triangle's vertices; the first is the number of the box
  std::array<double, 3> weights{};         ///< barycentric coordinates
  Vec3 motion = Vec3::Zero();  ///< derivative of t by the position of the hit point: n / (n · direction), n the normal
};

/// Appends to `hits` the nearest intersections of a ray with triangles in cells that are flagged in `active` (1 per
/// cell; the outermost cells must be 0), at most `most`, sorted. A triangle counts only where it lies in one of the
/// cells of its vertices. Then appends the hits of all nested boxes, which do not count.
void intersect(const FreeGrid& grid, const std::vector<std::uint8_t>& active, const Vec3& origin, const Vec3& direction,
               std::size_t most, std::vector<GridHit>& hits);

}  // namespace rebake
