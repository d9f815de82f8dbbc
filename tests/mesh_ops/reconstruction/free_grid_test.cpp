#include "mesh_ops/reconstruction/free_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace rebake;

namespace {

constexpr float half_a_cell = static_cast<float>(0.5 / FreeGrid::offset_cells);

// A grid with random vertices within the middle halves of their cells; some lie on the border of it.
FreeGrid random_grid(CaptureKind kind, int side, unsigned seed) {
  FreeGrid grid{GridSpace(kind, side)};
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> offset(-half_a_cell, half_a_cell);
  for (float& value : grid.offsets)
    value = random() % 8 == 0 ? (random() % 2 == 0 ? half_a_cell : -half_a_cell) : offset(random);
  grid.place_vertices();
  return grid;
}

std::vector<std::uint8_t> inner_cells(const GridSpace& space) {
  std::vector<std::uint8_t> inner(space.cell_count());
  for (std::uint32_t cell = 0; cell < inner.size(); ++cell) {
    const auto at = space.cell_of_number(cell);
    inner[cell] = std::all_of(at.begin(), at.end(), [&](int i) { return i >= 1 && i <= space.side() - 2; }) ? 1 : 0;
  }
  return inner;
}

struct GridRay {
  Vec3 origin, direction;
};

// Rays from outside, from inside and along axes.
std::vector<GridRay> grid_rays(CaptureKind kind, int count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> even(-1, 1);
  // One number after the other: the order of a call's arguments differs between compilers.
  const auto any = [&] {
    Vec3 result;
    for (double& value : result) value = even(random);
    return result;
  };
  std::vector<GridRay> rays;
  for (int k = 0; k < count; ++k) {
    if (kind == CaptureKind::forward) {
      const Vec3 origin = 0.3 * any(), aside = 0.8 * any();
      rays.push_back({origin, Vec3(aside.x(), aside.y(), -1)});
    } else {
      rays.push_back({(k % 2 == 0 ? 3.0 : 0.7) * any(), any()});
    }
    if (k % 10 == 0) rays.back().direction = -Vec3::Unit(kind == CaptureKind::forward ? 2 : k / 10 % 3);
  }
  return rays;
}

// All hits of a ray, by testing each triangle of each quad in long double.
std::vector<double> all_hits(const FreeGrid& grid, const std::vector<std::uint8_t>& active, const GridRay& ray) {
  using Long3 = Eigen::Matrix<long double, 3, 1>;
  const GridSpace& space = grid.space();
  std::vector<double> found;
  const Long3 o = ray.origin.cast<long double>(), d = ray.direction.cast<long double>();
  for (int axis = 0; axis < 3; ++axis)
    for (std::uint32_t number = 0; number < space.cell_count(); ++number) {
      const auto cells = GridQuad{axis, space.cell_of_number(number)}.cells();
      if (std::any_of(cells.begin(), cells.end(),
                      [&](const auto& cell) { return *std::max_element(cell.begin(), cell.end()) >= space.side(); }))
        continue;
      for (const auto& triangle : quad_triangles) {
        std::array<Long3, 3> p;
        std::array<std::uint32_t, 4> owners{};
        for (std::size_t k = 0; k < 4; ++k) owners[k] = space.cell_number(cells[k][0], cells[k][1], cells[k][2]);
        for (std::size_t k = 0; k < 3; ++k)
          p[k] = grid.positions()[owners[static_cast<std::size_t>(triangle[k])]].cast<long double>();
        Eigen::Matrix<long double, 3, 3> m;
        m << p[1] - p[0], p[2] - p[0], -d;
        if (std::abs(m.determinant()) < 1e-25L) continue;
        const Long3 x = m.inverse() * (o - p[0]);
        if (!(x[0] >= 0 && x[1] >= 0 && x[0] + x[1] <= 1 && x[2] > 0)) continue;
        const Vec3 place = space.to_cells(ray.origin + static_cast<double>(x[2]) * ray.direction);
        for (const std::uint32_t owner : owners) {
          const auto cell = space.cell_of_number(owner);
          if (active[owner] == 0) continue;
          if (static_cast<int>(std::floor(place.x())) == cell[0] &&
              static_cast<int>(std::floor(place.y())) == cell[1] && static_cast<int>(std::floor(place.z())) == cell[2])
            found.push_back(static_cast<double>(x[2]));
        }
      }
    }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

TEST(GridSpace, CellCoordinatesAreInvertedWithTheirSlopes) {
  for (const CaptureKind kind : {CaptureKind::object, CaptureKind::forward}) {
    const GridSpace space(kind, 24);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> place(0, 24), even(-1, 1);
    for (int k = 0; k < 100; ++k) {
      const Vec3 cells(place(random), place(random), place(random)), point = space.from_cells(cells);
      EXPECT_LT((space.to_cells(point) - cells).norm(), 1e-11);
      constexpr double step = 1e-5;
      const Mat3 slopes = space.from_cells_slopes(cells);
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 by = step * Vec3::Unit(axis);
        const Vec3 slope = (space.from_cells(cells + by) - space.from_cells(cells - by)) / (2 * step);
        EXPECT_LT((slopes.col(axis) - slope).norm(), 1e-7 * (1 + slope.norm()));
      }
      const Vec3 direction(even(random), even(random), even(random)), by = step * direction;
      const Vec3 along = (space.to_cells(point + by) - space.to_cells(point - by)) / (2 * step);
      EXPECT_LT((space.cells_along(point, direction) - along).norm(), 1e-6 * (1 + along.norm()));
    }
  }
}

TEST(FreeGrid, RaysHitTheTrianglesThatALongDoubleReferenceFinds) {
  for (const CaptureKind kind : {CaptureKind::object, CaptureKind::forward}) {
    const FreeGrid grid = random_grid(kind, 8, 3);
    const std::vector<std::uint8_t> active = inner_cells(grid.space());
    std::size_t total = 0;
    for (const GridRay& ray : grid_rays(kind, 50)) {
      std::vector<GridHit> hits;
      intersect(grid, active, ray.origin, ray.direction, 1000, hits);
      const std::vector<double> wanted = all_hits(grid, active, ray);
      ASSERT_EQ(hits.size(), wanted.size());
      for (std::size_t k = 0; k < hits.size(); ++k) EXPECT_NEAR(hits[k].t, wanted[k], 1e-10 * (1 + wanted[k]));
      total += hits.size();
    }
    EXPECT_GT(total, 100U);
  }
}

TEST(FreeGrid, KeepsTheNearestHitsAndLeavesOutInactiveCells) {
  const FreeGrid grid = random_grid(CaptureKind::object, 8, 9);
  const std::vector<std::uint8_t> active = inner_cells(grid.space());
  const GridRay ray{Vec3(-3, 0.11, 0.07), Vec3(1, 0.02, 0.01)};
  std::vector<GridHit> all, few, none;
  intersect(grid, active, ray.origin, ray.direction, 1000, all);
  intersect(grid, active, ray.origin, ray.direction, 3, few);
  intersect(grid, std::vector<std::uint8_t>(active.size()), ray.origin, ray.direction, 1000, none);
  ASSERT_GT(all.size(), 5U);
  ASSERT_EQ(few.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(few[k].t, all[k].t);
  EXPECT_TRUE(none.empty());
}

// The derivative of t by a vertex, against differences of the plane's intersection in long double; also for rays that
// graze the triangle.
TEST(FreeGrid, MotionOfHitsMatchesDifferences) {
  const FreeGrid grid = random_grid(CaptureKind::object, 8, 4);
  const std::vector<std::uint8_t> active = inner_cells(grid.space());
  std::vector<GridRay> rays = grid_rays(CaptureKind::object, 40);
  std::mt19937 random(8);
  // Rays almost within the plane of a triangle, to within 1e-6 of a radian.
  for (int k = 0; k < 40; ++k) {
    const auto corner = grid.space().cell_number(2 + k % 4, 3, 2 + k / 10);
    const Vec3 &a = grid.positions()[corner], &b = grid.positions()[corner + 1],
               &c = grid.positions()[corner + static_cast<std::uint32_t>(1 + grid.space().side())];
    const Vec3 normal = (b - a).cross(c - a).normalized(), inside = (a + b + c) / 3, along = (b - a).normalized();
    rays.push_back({inside - 0.05 * along - 0.05e-6 * normal, along + 1e-6 * normal});
  }
  using Long3 = Eigen::Matrix<long double, 3, 1>;
  double steepest = 0;
  for (const GridRay& ray : rays) {
    std::vector<GridHit> hits;
    intersect(grid, active, ray.origin, ray.direction, 1000, hits);
    for (const GridHit& hit : hits)
      for (std::size_t moved = 0; moved < 3; ++moved)
        for (int axis = 0; axis < 3; ++axis) {
          const auto t_for = [&](long double by) {
            std::array<Long3, 3> p;
            for (std::size_t k = 0; k < 3; ++k) p[k] = grid.positions()[hit.corners[k]].cast<long double>();
            p[moved][axis] += by;
            const Long3 n = (p[1] - p[0]).cross(p[2] - p[0]);
            return n.dot(p[0] - ray.origin.cast<long double>()) / n.dot(ray.direction.cast<long double>());
          };
          constexpr long double step = 1e-10L;
          const auto slope = static_cast<double>((t_for(step) - t_for(-step)) / (2 * step));
          const double size = hit.motion.norm();
          steepest = std::max(steepest, size);
          EXPECT_NEAR(hit.weights[moved] * hit.motion[axis], slope, 1e-6 * size);
        }
  }
  EXPECT_GT(steepest, 1e5);  // some rays did graze
}

TEST(FreeGrid, TrianglesWithoutAreaAreNotHit) {
  FreeGrid grid{GridSpace(CaptureKind::object, 4)};
  const std::vector<std::uint8_t> active = inner_cells(grid.space());
  // All vertices of the inner cells meet in the middle.
  for (std::uint32_t cell = 0; cell < active.size(); ++cell) {
    const auto at = grid.space().cell_of_number(cell);
    for (std::size_t axis = 0; axis < 3; ++axis)
      grid.offsets[3 * cell + axis] = static_cast<float>((2 - at[axis] - 0.5) / FreeGrid::offset_cells);
  }
  grid.place_vertices();
  std::vector<GridHit> hits;
  for (const GridRay& ray : grid_rays(CaptureKind::object, 100))
    intersect(grid, active, ray.origin, ray.direction, 1000, hits);
  intersect(grid, active, Vec3(-2, 0, 0), Vec3(1, 0, 0), 1000, hits);
  EXPECT_TRUE(hits.empty());
}

TEST(FreeGrid, OffsetSlopesFollowTheSpace) {
  const FreeGrid grid = random_grid(CaptureKind::forward, 8, 6);
  const std::uint32_t cell = grid.space().cell_number(3, 4, 5);
  std::vector<Vec3> position_slopes(grid.space().cell_count(), Vec3::Zero());
  position_slopes[cell] = Vec3(0.3, -0.2, 0.7);
  std::vector<float> slopes(grid.offsets.size());
  grid.offset_slopes(position_slopes, slopes);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    constexpr double step = 1e-5;
    const auto at = [&](double by) {
      Vec3 cells = grid.cells_of(cell);
      cells[static_cast<Eigen::Index>(axis)] += FreeGrid::offset_cells * by;
      return position_slopes[cell].dot(grid.space().from_cells(cells));
    };
    EXPECT_NEAR(double{slopes[3 * cell + axis]}, (at(step) - at(-step)) / (2 * step), 1e-4);
  }
}

TEST(FreeGrid, RaysLeaveEachNestedBoxOnceThroughASide) {
  const GridSpace space(CaptureKind::unbounded, 8, 17);
  EXPECT_NEAR(space.box_radius(0), 1, 1e-12);
  EXPECT_NEAR(space.box_radius(16), 16, 0.01);
  const FreeGrid grid{space};
  const std::vector<std::uint8_t> none(space.cell_count());
  std::size_t total = 0;
  for (const GridRay& ray : grid_rays(CaptureKind::object, 100)) {
    if (ray.origin.cwiseAbs().maxCoeff() > 1) continue;
    std::vector<GridHit> hits;
    intersect(grid, none, ray.origin, ray.direction, 10, hits);
    total += hits.size();
    for (std::size_t k = 0; k < hits.size(); ++k) {
      const Vec3 point = ray.origin + hits[k].t * ray.direction;
      const double radius = space.box_radius(static_cast<int>(hits[k].corners[0]));
      EXPECT_NEAR(std::max(std::abs(point.x()), std::abs(point.y())), radius, 1e-9 * radius);
      EXPECT_LT(std::abs(point.z()), radius);
      EXPECT_EQ(hits[k].cell, GridHit::no_cell);
      EXPECT_TRUE(k == 0 || hits[k].t > hits[k - 1].t);
      // Boxes and the grid share the fields' unit cube.
      const Vec3 place = space.box_place(static_cast<int>(hits[k].corners[0]), point);
      EXPECT_GE(place.minCoeff(), -1e-9);
      EXPECT_LE(place.maxCoeff(), 1 + 1e-9);
    }
    // Rays that are not steep leave all boxes.
    const double across = std::max(std::abs(ray.direction.x()), std::abs(ray.direction.y()));
    const bool flat = std::abs(ray.direction.z()) < 0.3 * across && std::abs(ray.origin.z()) < 0.3;
    EXPECT_TRUE(!flat || hits.size() == 17U);
  }
  EXPECT_GT(total, 300U);
  EXPECT_NEAR((space.field_place(Vec3(8, 0, 4)) - Vec3(0.75, 0.25, 0.5)).norm(), 0, 1e-12);
  EXPECT_NEAR((space.box_place(0, Vec3(1, -1, 0)) - Vec3(0.75, 0.25, 0.5)).norm(), 0, 1e-12);
}
