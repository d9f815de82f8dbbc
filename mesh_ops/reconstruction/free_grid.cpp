#include "mesh_ops/reconstruction/free_grid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rebake {

namespace {

// In-plane axes of a layer with this normal.
constexpr std::array<std::array<int, 2>, 3> in_plane{{{1, 2}, {0, 2}, {0, 1}}};

// Tests the triangle for the ray, and appends a hit in `cell`.
void hit_triangle(const FreeGrid& grid, const std::array<std::uint32_t, 3>& corners, const std::array<int, 3>& cell,
                  const Vec3& origin, const Vec3& direction, std::vector<GridHit>& hits) {
  const std::vector<Vec3>& positions = grid.positions();
  const Vec3 &a = positions[corners[0]], &b = positions[corners[1]], &c = positions[corners[2]];
  // Möller and Trumbore, Fast, minimum storage ray-triangle intersection (1997).
  const Vec3 ab = b - a, ac = c - a, p = direction.cross(ac);
  const double det = ab.dot(p);
  constexpr double relative = 1e-20;
  if (!(det * det > relative * ab.squaredNorm() * ac.squaredNorm() * direction.squaredNorm())) return;
  const Vec3 s = origin - a;
  const double u = s.dot(p) / det;
  if (!(u >= 0 && u <= 1)) return;
  const Vec3 q = s.cross(ab);
  const double v = direction.dot(q) / det;
  if (!(v >= 0 && u + v <= 1)) return;
  const double t = ac.dot(q) / det;
  if (!(t > 0)) return;
  const Vec3 place = grid.space().to_cells(origin + t * direction);
  for (int axis = 0; axis < 3; ++axis)
    if (!(place[axis] >= cell[static_cast<std::size_t>(axis)] &&
          place[axis] < cell[static_cast<std::size_t>(axis)] + 1))
      return;
  GridHit hit;
  hit.t = t;
  hit.cell = grid.space().cell_number(cell[0], cell[1], cell[2]);
  hit.corners = corners;
  hit.weights = {1 - u - v, u, v};
  const Vec3 normal = ab.cross(ac);
  hit.motion = normal / normal.dot(direction);
  hits.push_back(hit);
}

// The triangles around the vertex of a cell.
void hit_cell(const FreeGrid& grid, const std::array<int, 3>& cell, const Vec3& origin, const Vec3& direction,
              std::vector<GridHit>& hits) {
  for (int axis = 0; axis < 3; ++axis)
    for (int corner = 0; corner < 4; ++corner) {
      GridQuad quad{axis, cell};
      quad.first[static_cast<std::size_t>(in_plane[static_cast<std::size_t>(axis)][0])] -= corner % 2;
      quad.first[static_cast<std::size_t>(in_plane[static_cast<std::size_t>(axis)][1])] -= corner / 2;
      const auto cells = quad.cells();
      std::array<std::uint32_t, 4> numbers{};
      for (std::size_t k = 0; k < 4; ++k) numbers[k] = grid.space().cell_number(cells[k][0], cells[k][1], cells[k][2]);
      for (const auto& [i, j, k] : quad_triangles)
        hit_triangle(grid,
                     {numbers[static_cast<std::size_t>(i)], numbers[static_cast<std::size_t>(j)],
                      numbers[static_cast<std::size_t>(k)]},
                     cell, origin, direction, hits);
    }
}

}  // namespace

std::array<std::array<int, 3>, 4> GridQuad::cells() const {
  std::array<std::array<int, 3>, 4> result{first, first, first, first};
  const auto [b, c] = in_plane[static_cast<std::size_t>(axis)];
  for (const std::size_t k : {1U, 3U}) ++result[k][static_cast<std::size_t>(b)];
  for (const std::size_t k : {2U, 3U}) ++result[k][static_cast<std::size_t>(c)];
  return result;
}

FreeGrid::FreeGrid(const GridSpace& space)
    : offsets(3 * space.cell_count()), space_(space), positions_(space.cell_count()) {
  place_vertices();
}

Vec3 FreeGrid::cells_of(std::uint32_t cell) const {
  const std::array<int, 3> at = space_.cell_of_number(cell);
  Vec3 result;
  for (std::size_t axis = 0; axis < 3; ++axis)
    result[static_cast<Eigen::Index>(axis)] =
        at[axis] + 0.5 + offset_cells * static_cast<double>(offsets[3 * std::size_t{cell} + axis]);
  return result;
}

void FreeGrid::place_vertices() {
  tbb::parallel_for(std::size_t{0}, positions_.size(), [&](std::size_t cell) {
    positions_[cell] = space_.from_cells(cells_of(static_cast<std::uint32_t>(cell)));
  });
}

void FreeGrid::offset_slopes(const std::vector<Vec3>& position_slopes, std::vector<float>& slopes) const {
  tbb::parallel_for(std::size_t{0}, position_slopes.size(), [&](std::size_t cell) {
    Vec3 slope = Vec3::Zero();
    if (!position_slopes[cell].isZero(0))
      slope = offset_cells * space_.from_cells_slopes(cells_of(static_cast<std::uint32_t>(cell))).transpose() *
              position_slopes[cell];
    for (std::size_t axis = 0; axis < 3; ++axis)
      slopes[3 * cell + axis] = static_cast<float>(slope[static_cast<Eigen::Index>(axis)]);
  });
}

namespace {

// Appends hits of the grid's triangles.
void intersect_cells(const FreeGrid& grid, const std::vector<std::uint8_t>& active, const Vec3& origin,
                     const Vec3& direction, std::size_t most, std::vector<GridHit>& hits) {
  const GridSpace& space = grid.space();
  const auto range = space.range_of(origin, direction);
  if (!range) return;
  const std::size_t first = hits.size();
  const Vec3 entry = space.to_cells(origin + range->first * direction);
  std::array<int, 3> cell{}, trend{};
  std::array<double, 3> next{};
  const auto set_next = [&](std::size_t axis) {
    next[axis] = trend[axis] == 0 ? std::numeric_limits<double>::infinity()
                                  : space.crossing(static_cast<int>(axis), cell[axis] + (trend[axis] > 0 ? 1 : 0),
                                                   origin, direction);
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double place = entry[static_cast<Eigen::Index>(axis)];
    cell[axis] = static_cast<int>(std::clamp(std::floor(place), 0.0, space.side() - 1.0));
    trend[axis] = space.trend(static_cast<int>(axis), origin, direction);
    set_next(axis);
  }
  while (hits.size() - first < most) {
    if (active[space.cell_number(cell[0], cell[1], cell[2])] != 0) hit_cell(grid, cell, origin, direction, hits);
    const std::size_t axis = next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : (next[1] <= next[2] ? 1 : 2);
    if (!(next[axis] < range->second)) break;
    cell[axis] += trend[axis];
    if (cell[axis] < 0 || cell[axis] >= space.side()) break;
    set_next(axis);
  }
  std::stable_sort(hits.begin() + static_cast<std::ptrdiff_t>(first), hits.end(),
                   [](const GridHit& a, const GridHit& b) { return a.t < b.t; });
  hits.resize(std::min(hits.size(), first + most));
}

}  // namespace

void intersect(const FreeGrid& grid, const std::vector<std::uint8_t>& active, const Vec3& origin, const Vec3& direction,
               std::size_t most, std::vector<GridHit>& hits) {
  intersect_cells(grid, active, origin, direction, most, hits);
  for (int box = 0; box < grid.space().boxes(); ++box)
    if (const auto t = grid.space().box_exit(box, origin, direction)) {
      GridHit hit;
      hit.t = *t;
      hit.corners[0] = static_cast<std::uint32_t>(box);
      hits.push_back(hit);
    }
}

}  // namespace rebake
