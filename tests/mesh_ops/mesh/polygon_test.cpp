// Polygons are cut into triangles that cover them exactly.
#include "mesh_ops/mesh/polygon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "mesh_ops/base/error.h"

namespace rebake::test {
namespace {

using Triangle = std::array<std::size_t, 3>;

Vec3 area_of(const std::vector<Vec3>& corners) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < corners.size(); ++k)
    sum += (corners[k] - corners[0]).cross(corners[(k + 1) % corners.size()] - corners[0]) / 2;
  return sum;
}

// Expects corners − 2 triangles with the polygon's orientation whose areas sum up to its area.
void expect_covers(const std::vector<Vec3>& corners, const CutPolygon& cut) {
  ASSERT_EQ(cut.triangles.size() + 2, corners.size());
  const Vec3 whole = area_of(corners);
  double sum = 0;
  for (const Triangle& t : cut.triangles) {
    const double area = area_of({corners[t[0]], corners[t[1]], corners[t[2]]}).dot(whole.normalized());
    EXPECT_GT(area, -1e-12 * whole.norm());
    sum += area;
  }
  EXPECT_NEAR(sum, whole.norm(), 1e-12 * whole.norm());
}

TEST(Polygon, ConvexOnesAreFans) {
  const CutPolygon quad = cut_polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  EXPECT_EQ(quad.shape, PolygonShape::convex);
  EXPECT_EQ(quad.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  // A corner on an edge, and two corners at one place.
  EXPECT_EQ(cut_polygon({{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}, {1, 1, 0}}).shape, PolygonShape::convex);
  EXPECT_EQ(cut_polygon({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 1, 0}}).shape, PolygonShape::convex);
}

TEST(Polygon, ArrowheadsAreCutAtTheirNotch) {
  for (std::size_t start = 0; start < 4; ++start) {
    const std::vector<Vec3> arrow{{0, 0, 0}, {2, -1, 0}, {0, 3, 0}, {-2, -1, 0}};
    std::vector<Vec3> corners;
    for (std::size_t k = 0; k < 4; ++k) corners.push_back(arrow[(start + k) % 4]);
    const CutPolygon cut = cut_polygon(corners);
    EXPECT_EQ(cut.shape, PolygonShape::concave);
    expect_covers(corners, cut);
  }
}

TEST(Polygon, CrossingSidesAndNoArea) {
  EXPECT_EQ(cut_polygon({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1.5, 0}}).shape, PolygonShape::crossing);
  EXPECT_EQ(cut_polygon({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}).shape, PolygonShape::crossing);
  EXPECT_EQ(cut_polygon({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}).triangles.size(), 2U);
  std::vector<Vec3> star;  // a pentagram turns in one direction, but twice
  for (int k = 0; k < 5; ++k)
    star.emplace_back(std::cos(k * 4 * std::numbers::pi / 5), std::sin(k * 4 * std::numbers::pi / 5), 0);
  EXPECT_EQ(cut_polygon(star).shape, PolygonShape::crossing);
}

TEST(Polygon, RandomStarsAnywhereAreCovered) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  std::size_t concave = 0;
  for (int round = 0; round < 300; ++round) {
    const std::size_t count = 4 + random() % 20;
    const double size = std::pow(10, unit(random) * 12 - 6);
    const Mat3 turn = Eigen::Quaterniond::UnitRandom().toRotationMatrix();
    const Vec3 middle = Vec3(unit(random), unit(random), unit(random)) * size * 10;
    std::vector<Vec3> corners;
    for (std::size_t k = 0; k < count; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count);
      const double radius = 0.2 + 0.8 * unit(random);
      corners.push_back(middle + turn * Vec3(std::cos(angle), std::sin(angle), 0) * radius * size);
    }
    const CutPolygon cut = cut_polygon(corners);
    EXPECT_NE(cut.shape, PolygonShape::crossing) << round;
    concave += cut.shape == PolygonShape::concave ? 1 : 0;
    expect_covers(corners, cut);
  }
  EXPECT_GT(concave, 200U);
}

TEST(Polygon, LargeOnesMustBeConvex) {
  std::vector<Vec3> circle;
  for (int k = 0; k < 5000; ++k)
    circle.emplace_back(std::cos(k * 2 * std::numbers::pi / 5000), std::sin(k * 2 * std::numbers::pi / 5000), 0);
  EXPECT_EQ(cut_polygon(circle).shape, PolygonShape::convex);
  circle[7] *= 0.5;
  EXPECT_THROW(cut_polygon(circle), Error);
}

TEST(Polygon, SpiralsAreCovered) {
  std::vector<Vec3> corners;
  constexpr int steps = 60;
  for (int k = 0; k <= steps; ++k)
    corners.emplace_back((1 + 0.1 * k) * std::cos(0.3 * k), (1 + 0.1 * k) * std::sin(0.3 * k), 0);
  for (int k = steps; k >= 0; --k)
    corners.emplace_back((1.5 + 0.1 * k) * std::cos(0.3 * k), (1.5 + 0.1 * k) * std::sin(0.3 * k), 0);
  const CutPolygon cut = cut_polygon(corners);
  EXPECT_EQ(cut.shape, PolygonShape::concave);
  expect_covers(corners, cut);
}

}  // namespace
}  // namespace rebake::test
