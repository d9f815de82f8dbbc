// Deforming points with a cage: bitwise identity, rigid motions, and the accuracy of the float weights used for
// dragging.
#include "mesh_ops/deform/cage_coordinates/cage_deformation.h"
#include "editor/studies/gradient_binding.h"

#include <gtest/gtest.h>

#include "tests/support/hard_cages.h"

namespace rebake::test {
namespace {

// Weights sum to 1 up to rounding; a translation must not multiply that error by its length in diagonals.
TEST(CageDeformation, FarTranslationIsExact) {
  const Cage cage = dented();
  const Vec3 far(1e6, -3e6, 2e6);
  std::vector<Vec3> moved = cage.vertices;
  for (Vec3& v : moved) v += far;
  const std::vector<Vec3> points = hard_points(cage);
  const DeformedPoints result = deform_points(*mean_value_coordinates(cage), cage, moved, points, false);
  double worst = 0;
  for (std::size_t k = 0; k < points.size(); ++k)
    worst = std::max(worst, (result.points[k] - (points[k] + far)).norm());
  EXPECT_LE(worst, 1.5e-9) << "rounding at 3e6: half a unit in the last place per coordinate";
}

TEST(CageDeformation, IdentityIsBitExactAndDuplicatesMoveTogether) {
  const Cage cage = dented();
  std::vector<Vec3> points = hard_points(cage);
  points.insert(points.end(), points.begin(), points.end());  // duplicates, as unwelded corners have
  for (const CageCoordinates kind : {CageCoordinates::mean_value, CageCoordinates::green, CageCoordinates::harmonic}) {
    const auto coordinates = coordinates_of(cage, kind, 16);
    EXPECT_EQ(deform_points(*coordinates, cage, cage.vertices, points, true).points, points);
    std::vector<Vec3> moved = cage.vertices;
    for (Vec3& v : moved) v = Eigen::AngleAxisd(v.y() * 3, Vec3::UnitY()) * v;
    const DeformedPoints result = deform_points(*coordinates, cage, moved, points, false);
    for (std::size_t k = 0; k < points.size() / 2; ++k)
      ASSERT_EQ(result.points[k], result.points[k + points.size() / 2]);
  }
}

// A point that is no finite number of cage diagonals away has no coordinates; it must not take those of another.
TEST(CageDeformation, PointsTooFarForTheCageAreNotFinite) {
  Cage cage = dented();
  for (Vec3& v : cage.vertices) v *= 1e-10;
  std::vector<Vec3> moved = cage.vertices;
  for (Vec3& v : moved) v *= 2;
  const std::vector<Vec3> points{Vec3(0, 0, 0), Vec3(1e305, 0, 0), cage.vertices[0]};
  const DeformedPoints result = deform_points(*mean_value_coordinates(cage), cage, moved, points, false);
  EXPECT_TRUE(result.points[0].allFinite());
  EXPECT_FALSE(result.points[1].allFinite());
  EXPECT_EQ(result.points[2], moved[0]);
}

// Numbers of vertices belong to the user, so that unused ones stay in the cage; they must not count.
TEST(CageDeformation, VerticesThatNoFaceUsesChangeNoBits) {
  for (const auto& [name, cage] : hard_cages()) {
    if (cage.vertices.size() > 200) continue;
    std::vector<Vec3> points = hard_points(cage);
    points.resize(std::min<std::size_t>(points.size(), 40));
    std::vector<Vec3> moved = cage.vertices;
    for (Vec3& v : moved) v = v * 1.1 + Vec3(5, v.x(), 3);
    // One unused vertex before the others, two after them, at any distance and with any motion.
    Cage more;
    more.vertices.emplace_back(1e6, -3, 1e-9);
    more.vertices.insert(more.vertices.end(), cage.vertices.begin(), cage.vertices.end());
    more.vertices.emplace_back(-1e300, 1e300, 0);
    more.vertices.emplace_back(0, 0, 0);
    for (const Face& face : cage.faces) more.faces.push_back({face[0] + 1, face[1] + 1, face[2] + 1});
    std::vector<Vec3> more_moved{Vec3(-1e200, 0, 0)};
    more_moved.insert(more_moved.end(), moved.begin(), moved.end());
    more_moved.emplace_back(1.7e308, -1.7e308, 3);
    more_moved.emplace_back(0, 0, 0);
    const Cage checked = checked_cage(more);
    EXPECT_EQ(checked.faces == more.faces, checked_cage(cage).faces == cage.faces) << name;
    EXPECT_EQ(volume(more), volume(cage)) << name;
    for (const CageCoordinates kind : {CageCoordinates::mean_value, CageCoordinates::green}) {
      const auto expected = deform_points(*coordinates_of(cage, kind, 0), cage, moved, points, true);
      const auto found = deform_points(*coordinates_of(more, kind, 0), more, more_moved, points, true);
      EXPECT_EQ(found.points, expected.points) << name << ", " << static_cast<int>(kind);
      EXPECT_EQ(found.jacobians, expected.jacobians) << name << ", " << static_cast<int>(kind);
      EXPECT_EQ(found.outside, expected.outside) << name << ", " << static_cast<int>(kind);
    }
    if (name != "dented") continue;  // thin ones need many cells
    const auto expected = deform_points(*harmonic_coordinates(cage, 12), cage, moved, points, false);
    const auto found = deform_points(*harmonic_coordinates(more, 12), more, more_moved, points, false);
    EXPECT_EQ(found.outside, expected.outside);
    // Vertices are solved for in groups, and a group iterates until all of it has converged.
    for (std::size_t k = 0; k < points.size(); ++k) EXPECT_LE((found.points[k] - expected.points[k]).norm(), 1e-12);
  }
}

TEST(CageDeformation, RigidCageMotionsMovePointsRigidly) {
  const Cage cage = dented();
  const Affine motion =
      Eigen::Translation3d(0.2, -3, 1) * Eigen::AngleAxisd(3.141592653589793, Vec3(1, 2, 3).normalized());
  std::vector<Vec3> moved;
  for (const Vec3& v : cage.vertices) moved.push_back(motion * v);
  std::vector<Vec3> points;
  for (const Vec3& p : inside_points(cage)) points.push_back(p);
  for (const CageCoordinates kind : {CageCoordinates::mean_value, CageCoordinates::green, CageCoordinates::harmonic}) {
    const DeformedPoints result = deform_points(*coordinates_of(cage, kind, 16), cage, moved, points, true);
    double worst = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      ASSERT_EQ(result.outside[k], 0) << points[k].transpose();
      worst = std::max(worst, (result.points[k] - motion * points[k]).norm());
    }
    EXPECT_LE(worst, kind == CageCoordinates::harmonic ? 1e-9 : 1e-13) << static_cast<int>(kind);
  }
}

// The window's preview of a cage and the edit that commits it share one set of coordinates.
TEST(CageDeformation, SharesCoordinatesThatAreInUse) {
  const Cage cage = dented();
  Cage other = cage;
  other.vertices[0] *= 1 + 1e-15;
  auto held = shared_coordinates(cage, CageCoordinates::harmonic, 16);
  EXPECT_EQ(shared_coordinates(Cage(cage), CageCoordinates::harmonic, 16), held);
  EXPECT_NE(shared_coordinates(cage, CageCoordinates::harmonic, 17), held);
  EXPECT_NE(shared_coordinates(cage, CageCoordinates::green, 16), held);
  EXPECT_NE(shared_coordinates(other, CageCoordinates::harmonic, 16), held);
  const std::weak_ptr<const Coordinates> gone = held;
  held.reset();
  EXPECT_TRUE(gone.expired()) << "the cache must not own the coordinates";
}

TEST(CageDeformation, PointsOutsideTheDomainStay) {
  const Cage cage = cube();
  std::vector<Vec3> moved = cage.vertices;
  for (Vec3& v : moved) v.x() += 1;
  const std::vector<Vec3> points{{3, 3, 3}, {0, 0, 0}};
  for (const CageCoordinates kind : {CageCoordinates::green, CageCoordinates::harmonic}) {
    const auto coordinates = coordinates_of(cage, kind, 16);
    const DeformedPoints result = deform_points(*coordinates, cage, moved, points, true);
    EXPECT_EQ(result.points[0], points[0]);
    EXPECT_TRUE(result.jacobians[0].isIdentity(0));
    EXPECT_NEAR(result.points[1].x(), 1, 1e-12);
    std::vector<Vec3> bound;
    CageBinding(*coordinates, cage, points).positions(moved, bound);
    EXPECT_EQ(bound[0], points[0]);
    EXPECT_NEAR(bound[1].x(), 1, 1e-6);
  }
}

TEST(CageDeformation, BindingIsAccurateToOneMillionth) {
  const Cage cage = dented();
  const auto coordinates = mean_value_coordinates(cage);
  const std::vector<Vec3> points = hard_points(cage);
  const CageBinding binding(*coordinates, cage, points);
  std::vector<Vec3> moved = cage.vertices;
  moved[3] += Vec3(0.3, 0.1, 0);
  moved[9] += Vec3(0, -0.4, 0.2);
  const DeformedPoints exact = deform_points(*coordinates, cage, moved, points, true);
  std::vector<Vec3> bound;
  binding.positions(moved, bound);
  for (std::size_t k = 0; k < points.size(); ++k) ASSERT_LE((bound[k] - exact.points[k]).norm(), 1e-6);
  binding.positions(cage.vertices, bound);
  EXPECT_EQ(bound, points);
  std::vector<Mat3> all, some;
  const GradientBinding gradients(*coordinates, cage, points);
  gradients.rotations(moved, all);
  gradients.rotations(moved, some, 4);
  std::size_t same = 0;
  for (std::size_t k = 0; k < all.size(); ++k) same += all[k] == some[k] ? 1 : 0;
  EXPECT_GE(same, all.size() / 4);
  EXPECT_LT(same, all.size());
}

}  // namespace
}  // namespace rebake::test
