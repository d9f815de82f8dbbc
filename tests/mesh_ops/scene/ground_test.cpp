// The ground plane: exact cases and random planes.
#include "mesh_ops/scene/ground_plane.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace rebake::test {
namespace {

Vec3 random_vector(std::mt19937& random) {
  std::normal_distribution<double> any;
  return {any(random), any(random), any(random)};
}

TEST(Ground, FrameRotatesUpToTheNormal) {
  std::mt19937 random(1);
  for (int k = 0; k < 200; ++k) {
    const Ground ground{random_vector(random).normalized(), 0};
    const Mat3 frame = ground_frame(ground);
    EXPECT_LE((frame.transpose() * frame - Mat3::Identity()).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_NEAR(frame.determinant(), 1, 1e-14);
    EXPECT_LE((frame.col(1) - ground.normal).norm(), 1e-15);
  }
  EXPECT_EQ(ground_frame({}), Mat3::Identity());
}

TEST(Ground, ThroughThreePointsAtAnyScaleAndDistance) {
  std::mt19937 random(2);
  for (const double scale : {1e-9, 1.0, 1e9})
    for (int k = 0; k < 100; ++k) {
      const Vec3 far = 1000 * scale * random_vector(random);
      const std::array<Vec3, 3> points{far + scale * random_vector(random), far + scale * random_vector(random),
                                       far + scale * random_vector(random)};
      const Ground ground = ground_through(points);
      EXPECT_GE(ground.normal.y(), 0);
      for (const Vec3& point : points) EXPECT_LE(std::abs(ground.above(point)), 1e-10 * far.norm());
    }
}

TEST(Ground, RejectsCollinearPoints) {
  EXPECT_THROW(ground_through({Vec3(0, 0, 0), Vec3(1, 1, 1), Vec3(3, 3, 3)}), std::invalid_argument);
  EXPECT_THROW(ground_through({Vec3(0, 0, 0), Vec3(0, 0, 0), Vec3(3, 3, 3)}), std::invalid_argument);
  EXPECT_THROW(ground_through({Vec3(0, 0, 0), Vec3(1e300, 0, std::nan("")), Vec3(3, 3, 3)}), std::invalid_argument);
}

TEST(Ground, LowestCornerOfABoxAboveATiltedPlane) {
  const Ground ground{Vec3(1, 1, 0).normalized(), 0};
  EXPECT_NEAR(lowest_above(ground, Box(Vec3(1, 2, 3), Vec3(4, 5, 6))), 3 / std::sqrt(2.0), 1e-15);
}

}  // namespace
}  // namespace rebake::test
