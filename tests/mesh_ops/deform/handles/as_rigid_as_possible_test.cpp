// Handles: rigid motions are exact, iterations reduce energy, and free components stay.
#include "mesh_ops/deform/handles/as_rigid_as_possible.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "mesh_ops/base/error.h"

namespace rebake::test {
namespace {

TEST(Handles, HeldVerticesAreExactAndTheRestIsRigid) {
  const Cage cage = lattice_cage(Box(Vec3(0, 0, 0), Vec3(1, 4, 1)), 2, 8, 2);
  std::vector<ConstrainedVertex> held;
  const Affine lifted = Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.7, Vec3::UnitZ());
  for (std::uint32_t v = 0; v < cage.vertices.size(); ++v)
    if (cage.vertices[v].y() < 0.1) held.push_back({v, lifted * cage.vertices[v]});
  const ConstrainedCage moved = as_rigid_as_possible(cage, held, 500);
  EXPECT_EQ(moved.free_components, 0U);
  for (const ConstrainedVertex& h : held) EXPECT_EQ(moved.vertices[h.vertex], h.place);
  // With one end moved rigidly and the other free, the minimum is that rigid motion.
  for (std::size_t v = 0; v < cage.vertices.size(); ++v)
    EXPECT_LE((moved.vertices[v] - lifted * cage.vertices[v]).norm(), 1e-13);
  EXPECT_THROW(as_rigid_as_possible(cage, {}, 5), Error);
}

// Iterations start at the best rigid fit to the handles. From the cage at rest, ten of them would leave a rotation by 3
// rad short by 2 to 44 % of the diagonal.
TEST(Handles, RigidMotionsAreExactAtAnyAngle) {
  const Cage cage = lattice_cage(Box(Vec3(0, 0, 0), Vec3(1, 4, 1)), 2, 8, 2);
  for (const double angle : {1e-9, 0.5, 1.5, 3.0, 3.14159265358979})
    for (const std::size_t count : {std::size_t{3}, std::size_t{9}, cage.vertices.size()}) {
      const Affine motion = Eigen::Translation3d(5, -2, 3) * Eigen::AngleAxisd(angle, Vec3(1, 2, -1).normalized());
      std::vector<ConstrainedVertex> held;
      for (std::uint32_t v = 0; v < count; ++v) held.push_back({v * 29 % 74, motion * cage.vertices[v * 29 % 74]});
      const ConstrainedCage moved = as_rigid_as_possible(cage, held, 10);
      for (std::size_t v = 0; v < cage.vertices.size(); ++v)
        ASSERT_LE((moved.vertices[v] - motion * cage.vertices[v]).norm(), 1e-12) << angle << " with " << count;
      EXPECT_LE(moved.energy, 1e-20);
    }
}

// Two handles define one direction at rest and one moved. Near 180° the axis of the rotation between them is
// ill-conditioned: its error is rounding divided by the remaining angle.
TEST(Handles, TwoHandlesRotateTheCageRigidlyUpTo180Degrees) {
  const Cage cage = lattice_cage(Box(Vec3(0, 0, 0), Vec3(1, 4, 1)), 2, 8, 2);
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 40; ++k) {
    const double left = std::pow(10.0, -0.3 * k), angle = std::numbers::pi - left;
    const std::uint32_t first = random() % 74, second = (first + 1 + random() % 73) % 74;
    const Vec3 along = cage.vertices[second] - cage.vertices[first];
    const Vec3 axis = along.cross(Vec3(normal(random), normal(random), normal(random))).normalized();
    const Affine motion = Eigen::Translation3d(5, -2, 3) * Eigen::AngleAxisd(angle, axis);
    std::vector<ConstrainedVertex> held;
    for (const std::uint32_t v : {first, second}) held.push_back({v, motion * cage.vertices[v]});
    const ConstrainedCage moved = as_rigid_as_possible(cage, held, 10);
    double worst = 0;
    for (std::size_t v = 0; v < cage.vertices.size(); ++v)
      worst = std::max(worst, (moved.vertices[v] - motion * cage.vertices[v]).norm());
    EXPECT_LE(worst, 1e-12 + 2e-14 / left) << "at 180° less " << left;
    EXPECT_LE(moved.energy, 1e-20);
  }
}

TEST(Handles, UnmovedHandlesChangeNoBit) {
  const Cage cage = lattice_cage(Box(Vec3(0.1, 0.2, 0.3), Vec3(1, 4, 1)), 2, 8, 2);
  std::vector<ConstrainedVertex> held;
  for (std::uint32_t v = 0; v < cage.vertices.size(); v += 5) held.push_back({v, cage.vertices[v]});
  EXPECT_EQ(as_rigid_as_possible(cage, held, 10).vertices, cage.vertices);
}

TEST(Handles, IterationsStopAtTheResidualAndReduceEnergy) {
  const Cage cage = lattice_cage(Box(Vec3(0, 0, 0), Vec3(1, 4, 1)), 2, 8, 2);
  std::vector<ConstrainedVertex> held;
  const Affine turned =
      Eigen::Translation3d(0.5, 4, 0.5) * Eigen::AngleAxisd(1.2, Vec3::UnitZ()) * Eigen::Translation3d(-0.5, -4, -0.5);
  for (std::uint32_t v = 0; v < cage.vertices.size(); ++v) {
    if (cage.vertices[v].y() < 0.1) held.push_back({v, cage.vertices[v]});
    if (cage.vertices[v].y() > 3.9) held.push_back({v, turned * cage.vertices[v]});
  }
  const ConstrainedCage few = as_rigid_as_possible(cage, held, 5), many = as_rigid_as_possible(cage, held, 1000);
  EXPECT_EQ(few.iterations, 5);
  EXPECT_GT(few.residual, handles_residual);
  EXPECT_LT(many.iterations, 1000);
  EXPECT_LE(many.residual, handles_residual);
  EXPECT_GT(many.energy, 0);
  EXPECT_LT(many.energy, few.energy);
}

TEST(Handles, IsolatedVertexMovesNothing) {
  Cage cage = lattice_cage(Box(Vec3(0, 0, 0), Vec3(1, 1, 1)), 1, 1, 1);
  cage.vertices.emplace_back(5, 5, 5);
  EXPECT_THROW(as_rigid_as_possible(cage, {{8, Vec3(6, 6, 6)}}, 5), Error);
  const ConstrainedCage moved = as_rigid_as_possible(cage, {{0, cage.vertices[0]}, {8, Vec3(6, 6, 6)}}, 5);
  EXPECT_EQ(moved.vertices[8], Vec3(6, 6, 6));
  EXPECT_LE((moved.vertices[7] - cage.vertices[7]).norm(), 1e-6);
}

TEST(Handles, UnheldComponentStays) {
  Cage cage = lattice_cage(Box(Vec3(0, 0, 0), Vec3(1, 1, 1)), 1, 1, 1);
  const Cage other = lattice_cage(Box(Vec3(3, 0, 0), Vec3(4, 1, 1)), 1, 1, 1);
  for (const Face& face : other.faces) cage.faces.push_back({face[0] + 8, face[1] + 8, face[2] + 8});
  cage.vertices.insert(cage.vertices.end(), other.vertices.begin(), other.vertices.end());
  const ConstrainedCage moved = as_rigid_as_possible(cage, {{0, Vec3(-1, 0, 0)}, {7, Vec3(1, 1, 1)}}, 5);
  EXPECT_EQ(moved.free_components, 1U);
  for (std::size_t v = 8; v < 16; ++v) EXPECT_EQ(moved.vertices[v], cage.vertices[v]);
}

}  // namespace
}  // namespace rebake::test
