// Harmonic coordinates compared with known solutions: second order up to the surface, exact for linear functions.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mesh_ops/deform/cage_coordinates/coordinates.h"
#include "mesh_ops/deform/cage_coordinates/dirichlet_grid.h"
#include "tests/support/coordinate_errors.h"
#include "tests/support/hard_cages.h"
#include "tests/support/thorough.h"

namespace rebake::test {
namespace {

double linear(const Vec3& p) { return 0.3 + p.x() - 2 * p.y() + 0.7 * p.z(); }
double quadratic(const Vec3& p) { return p.x() * p.x() + p.y() * p.z() - p.z() * p.z(); }
double waves(const Vec3& p) { return std::exp(3 * p.x()) * std::sin(3 * p.y() + 0.4); }

struct GridErrors {
  double nodes = 0;   ///< largest error at inner nodes
  double points = 0;  ///< largest error at points between nodes, most of them on or near the surface
};

// Errors of the grid's solution if its boundary values are those of `function`, which must be harmonic.
GridErrors grid_errors(const Cage& cage, int resolution, double (*function)(const Vec3&)) {
  DirichletGrid grid(cage, resolution);
  EXPECT_TRUE(grid.isolated_nodes().empty());
  std::vector<GridLanes> surface, values;
  for (const SurfacePoint& point : grid.surface()) {
    Vec3 place(0, 0, 0);
    for (std::size_t k = 0; k < 3; ++k) place += point.corners[k] * cage.vertices[cage.faces[point.face][k]];
    surface.push_back(GridLanes::Constant(function(place)));
  }
  grid.solve(surface, values);
  GridErrors errors;
  for (std::size_t node = 0; node < grid.inside_nodes(); ++node)
    errors.nodes = std::max(errors.nodes, std::abs(values[node][3] - function(grid.place(node))));
  const auto look = [&](const Vec3& p) {
    DirichletGrid::Cell cell;
    ASSERT_TRUE(grid.find_cell(p, cell));
    double value = 0;
    for (std::size_t k = 0; k < 8; ++k)
      value += values[cell.nodes[k]][3] * ((k & 1U) != 0 ? cell.at.x() : 1 - cell.at.x()) *
               ((k & 2U) != 0 ? cell.at.y() : 1 - cell.at.y()) * ((k & 4U) != 0 ? cell.at.z() : 1 - cell.at.z());
    errors.points = std::max(errors.points, std::abs(value - function(p)));
  };
  for (const Vec3& p : inside_points(cage)) look(p);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(0, 1);
  for (const Face& face : cage.faces)
    for (int k = 0; k < 100; ++k) {
      const double a = any(random), b = any(random) * (1 - a);
      const Vec3 &u = cage.vertices[face[0]], &v = cage.vertices[face[1]], &w = cage.vertices[face[2]];
      const Vec3 on = a * u + b * v + (1 - a - b) * w;
      look(on);
      look(on - 1e-3 * any(random) * (v - u).cross(w - u).normalized());
    }
  return errors;
}

TEST(Harmonic, LinearAndQuadraticSolutionsAreExactAtTheNodes) {
  for (const auto& [name, cage] : {std::pair("cube", cube()), std::pair("dented", dented())})
    for (const int resolution : {16, 17 + 2 * thorough, 8 * thorough}) {
      const GridErrors flat = grid_errors(cage, resolution, linear), curved = grid_errors(cage, resolution, quadratic);
      EXPECT_LE(flat.nodes, 1e-13) << name << ' ' << resolution;
      EXPECT_LE(flat.points, 1e-13) << name << ' ' << resolution;
      EXPECT_LE(curved.nodes, 1e-13) << name << ' ' << resolution;
    }
}

// Halving the cell size must divide the error by four. Mean value weights at nodes near the surface would only halve
// it.
TEST(Harmonic, SecondOrderUpToTheSurface) {
  for (const auto& [name, cage] : {std::pair("cube", cube()), std::pair("dented", dented())})
    for (const auto function : {quadratic, waves}) {
      const GridErrors coarse = grid_errors(cage, 12, function), fine = grid_errors(cage, 48, function);
      EXPECT_LE(fine.points, coarse.points / 11) << name;
      EXPECT_LE(fine.points, 5e-4 * (64.0 / 48) * (64.0 / 48)) << name;
      if (function == waves) {
        EXPECT_LE(fine.nodes, coarse.nodes / 11) << name;
      }
    }
}

// Multigrid: coarse grids must end where the finest one does, for any number of cells along each axis.
TEST(Harmonic, BoxesWithAnyNumberOfCells) {
  constexpr int most = 24;
  const auto look = [](const Vec3& size) {
    const Cage box = lattice_cage(Box(Vec3(0, 0, 0), size), 1, 1, 1);
    const CoordinateErrors errors = errors_of(*harmonic_coordinates(box, most), box, {size / 2, size / 3, size * 0.9});
    EXPECT_LE(errors.sum, 1e-12) << size.transpose();
    EXPECT_LE(errors.linear, 1e-12) << size.transpose();
  };
  for (int cells = 8; cells <= most; cells += thorough == 1 ? 3 : 1)
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 size = Vec3::Constant(11.0 / most);
      size[(axis + 1) % 3] = 1;
      size[axis] = (cells - 0.01) / most;
      look(size);
    }
}

TEST(Harmonic, SumsAndLinearFunctionsAreExactOnHardCages) {
  for (const auto& [name, cage] : hard_cages())
    for (const int resolution : {8, 24}) {
      const std::unique_ptr<Coordinates> coordinates = harmonic_coordinates(cage, resolution);
      const CoordinateErrors errors = errors_of(*coordinates, cage, inside_points(cage));
      EXPECT_LE(errors.sum, 1e-12) << name << ' ' << resolution;
      EXPECT_LE(errors.linear, 1e-12) << name << ' ' << resolution;
    }
}

// Cells larger than twice a cage's thickness would give unbounded weights (±148 in a rotated box of thickness 1e-6).
TEST(Harmonic, RejectsThinCagesAndBoundsWeightsOfOthers) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share(-0.49, 0.49);
  double least = 0, largest = 1;
  for (const double thickness : {1e-8, 1e-4, 0.012, 0.02, 0.05})
    for (int turn = 0; turn < 3; ++turn) {
      Cage cage = lattice_cage(Box(Vec3(-0.5, -0.5, -thickness / 2), Vec3(0.5, 0.5, thickness / 2)), 1, 1, 1);
      const Mat3 rotation =
          Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized().matrix();
      for (Vec3& v : cage.vertices) v = rotation * v;
      if (thickness < 0.01) {
        EXPECT_THROW(harmonic_coordinates(cage, 32), FieldError) << thickness;
        continue;
      }
      const auto coordinates = harmonic_coordinates(cage, 64);
      for (int k = 0; k < 20; ++k)
        for (const double weight :
             weights_at(*coordinates, rotation * Vec3(share(random), share(random), thickness * share(random)))) {
          least = std::min(least, weight);
          largest = std::max(largest, weight);
        }
    }
  EXPECT_GE(least, -0.05);
  EXPECT_LE(largest, 1.05);
}

// Harmonic coordinates are non-negative everywhere (Joshi et al. 2007); so are the grid's weights at its nodes.
TEST(Harmonic, WeightsAreNotNegative) {
  const Cage cage = dented();
  const auto coordinates = harmonic_coordinates(cage, 32);
  for (const Vec3& p : {Vec3(-0.1, 0.05, 0.02), Vec3(0, 0, 0), Vec3(-0.2, 0.1, -0.1)})
    for (const double weight : weights_at(*coordinates, p)) EXPECT_GE(weight, -1e-14);
}

TEST(Harmonic, RejectsInvalidResolutions) {
  EXPECT_THROW(harmonic_coordinates(dented(), 4), FieldError);
  EXPECT_THROW(harmonic_coordinates(dented(), 257), FieldError);
  EXPECT_THROW(harmonic_coordinates(cube(12), 256), FieldError);
}

}  // namespace
}  // namespace rebake::test
