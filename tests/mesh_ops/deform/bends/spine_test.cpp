// Spine: the line along which a part is bent. It follows the part's shape and starts where the part is attached.
#include "mesh_ops/deform/bends/spine.h"

#include <gtest/gtest.h>

#include <numbers>

namespace rebake::test {
namespace {

// A cylinder of points around the line `from` … `to`.
std::vector<WeightedPoint> branch(const Vec3& from, const Vec3& to, double radius) {
  std::vector<WeightedPoint> points;
  const Vec3 along = (to - from).normalized(), u = along.unitOrthogonal(), v = along.cross(u);
  constexpr int rings = 40, around = 12;
  for (int i = 0; i <= rings; ++i)
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * k / around;
      points.push_back({from + (to - from) * i / rings + radius * (std::cos(angle) * u + std::sin(angle) * v), 1});
    }
  return points;
}

TEST(Spine, CurveFollowsTheCentreOfThePart) {
  // A quarter of a torus with radii 2 and 0.1.
  std::vector<WeightedPoint> part;
  for (int i = 0; i <= 90; ++i)
    for (int k = 0; k < 12; ++k) {
      const double turn = i * std::numbers::pi / 180, around = k * std::numbers::pi / 6;
      const double radius = 2 + 0.1 * std::cos(around);
      part.push_back({Vec3(radius * std::cos(turn), radius * std::sin(turn), 0.1 * std::sin(around)), 1});
    }
  const auto spine = spine_of(part, {{Vec3(2, -0.05, 0), 1}});
  ASSERT_TRUE(spine);
  double worst = 0;
  for (const Vec3& p : spine->curve) worst = std::max(worst, std::abs(Vec2(p.x(), p.y()).norm() - 2));
  EXPECT_LT(worst, 0.08) << "the straight line is 0.3 off in the middle";
  EXPECT_LT((spine->curve.front() - Vec3(2, 0, 0)).norm(), 0.25);
  EXPECT_LT((spine->curve.back() - Vec3(0, 2, 0)).norm(), 0.25);
  // The curve of a straight branch is a straight line.
  const auto straight = spine_of(branch({0, 0, 0}, {0, 2, 0}, 0.1), {});
  for (const Vec3& p : straight->curve) EXPECT_LT(Vec2(p.x(), p.z()).norm(), 1e-12);
  EXPECT_LT((straight->curve.front() - straight->foot).norm(), 1e-12);
  EXPECT_NEAR(straight->curve.back().y(), 2, 1e-12);
}

TEST(Spine, FollowsABranchFromItsStem) {
  const Vec3 stem(0, 2, 0), tip(1.5, 3, 0.7);
  const auto trunk = branch({0, 0, 0}, {0, 4, 0}, 0.2);
  for (const double scale : {1e-6, 1.0, 1e6}) {
    std::vector<WeightedPoint> part = branch(stem, tip, 0.05), rest = trunk;
    for (auto* points : {&part, &rest})
      for (WeightedPoint& point : *points) point.at *= scale;
    const auto spine = spine_of(part, rest);
    ASSERT_TRUE(spine);
    EXPECT_LT((spine->along - (tip - stem).normalized()).norm(), 1e-3);
    EXPECT_LT((spine->foot / scale - stem).norm(), 0.02) << "the foot must be at the stem";
    EXPECT_NEAR(spine->length / scale, (tip - stem).norm(), 0.1);
    EXPECT_NEAR(spine->width / scale, 0.1, 0.01) << "its diameter";
    EXPECT_LT(spine->touched, 0.2) << "contact at the stem only";
  }
  // The same branch, attached at its other end.
  const auto other = spine_of(branch(stem, tip, 0.05), branch(tip, tip + Vec3(0, 1, 0), 0.1));
  ASSERT_TRUE(other);
  EXPECT_LT((other->foot - tip).norm(), 0.05);
}

TEST(Spine, WithoutARestStartsAtTheLowerEnd) {
  const auto spine = spine_of(branch({0, 5, 0}, {0.2, 1, 0}, 0.1), {});
  ASSERT_TRUE(spine);
  EXPECT_LT((spine->foot - Vec3(0.2, 1, 0)).norm(), 0.05);
  EXPECT_GT(spine->along.y(), 0.99);
}

TEST(Spine, RoundPartLeadsFromTheRestToItsCentre) {
  std::vector<WeightedPoint> ball;
  // Equal area per point: uniform in z and in angle.
  constexpr int rings = 40, around = 40;
  for (int i = 0; i < rings; ++i)
    for (int k = 0; k < around; ++k) {
      const double z = -1 + (2 * i + 1.0) / rings, radius = std::sqrt(1 - z * z),
                   angle = 2 * std::numbers::pi * k / around;
      ball.push_back({Vec3(3 + radius * std::cos(angle), radius * std::sin(angle), z), 1});
    }
  const auto spine = spine_of(ball, branch({1.97, -0.1, 0}, {1.97, 0.1, 0}, 0.02));
  ASSERT_TRUE(spine);
  EXPECT_GT(spine->along.x(), 0.95);
}

TEST(Spine, ReportsContactAlongTheWholeLength) {
  const auto all = branch({0, 0, 0}, {2, 0, 0}, 0.1);
  std::vector<WeightedPoint> front, back;
  for (const WeightedPoint& point : all) (point.at.z() > 0 ? front : back).push_back(point);
  const auto spine = spine_of(front, back);
  ASSERT_TRUE(spine);
  EXPECT_GT(spine->touched, 0.8);
}

TEST(Spine, EmptyForAPoint) {
  EXPECT_FALSE(spine_of({}, {}));
  EXPECT_FALSE(spine_of({{Vec3(1, 2, 3), 1}, {Vec3(1, 2, 3), 1}}, {}));
}

}  // namespace
}  // namespace rebake::test
