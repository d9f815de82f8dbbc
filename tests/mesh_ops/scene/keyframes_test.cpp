// Values between keyframes.
#include "mesh_ops/scene/keyframes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "mesh_ops/base/error.h"

namespace rebake::test {
namespace {

Keyframes<double> numbers(const std::vector<std::pair<double, double>>& list,
                          Interpolation to_next = Interpolation::smooth) {
  Keyframes<double> keys;
  for (const auto& [seconds, value] : list) set_key(keys, {seconds, value, to_next});
  return keys;
}

Affine rotated(double degrees, const Vec3& axis = Vec3::UnitY()) {
  Affine affine = Affine::Identity();
  affine.linear() = Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()).toRotationMatrix();
  return affine;
}

TEST(Keyframes, AreSortedByTimeAndReplacedAtTheSameTime) {
  Keyframes<double> keys = numbers({{2, 20}, {1, 10}, {3, 30}, {1, 11}});
  ASSERT_EQ(keys.size(), 3U);
  EXPECT_EQ(keys[0].value, 11);
  EXPECT_TRUE(remove_key(keys, 2));
  EXPECT_FALSE(remove_key(keys, 2));
  EXPECT_EQ(keys.size(), 2U);
}

TEST(Keyframes, HoldTheirValuesExactlyAndOutsideOfTheirRange) {
  const Keyframes<double> keys = numbers({{1, 0.1}, {2, 0.7}, {4, -3}});
  for (const auto& key : keys) EXPECT_EQ(value_at(keys, key.seconds), key.value);
  EXPECT_EQ(value_at(keys, -5), 0.1);
  EXPECT_EQ(value_at(keys, 9), -3);
}

TEST(Keyframes, StepAndLinearAreWhatTheySay) {
  EXPECT_EQ(value_at(numbers({{0, 1}, {2, 5}}, Interpolation::step), 1.999), 1);
  EXPECT_DOUBLE_EQ(value_at(numbers({{0, 1}, {2, 5}}, Interpolation::linear), 0.5), 2);
}

TEST(Keyframes, SmoothNumbersNeverOvershootAndHaveAContinuousVelocity) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> value(-10, 10), gap(0.01, 3);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::pair<double, double>> list;
    double time = 0;
    for (int k = 0; k < 6; ++k) list.emplace_back(time += gap(random), k % 3 == 2 ? list.back().second : value(random));
    const Keyframes<double> keys = numbers(list);
    for (std::size_t k = 0; k + 1 < keys.size(); ++k) {
      const double low = std::min(keys[k].value, keys[k + 1].value), high = std::max(keys[k].value, keys[k + 1].value);
      for (double share = 0; share <= 1; share += 0.05) {
        const double at = value_at(keys, keys[k].seconds + share * (keys[k + 1].seconds - keys[k].seconds));
        EXPECT_GE(at, low - 1e-12 * std::abs(low) - 1e-12);
        EXPECT_LE(at, high + 1e-12 * std::abs(high) + 1e-12);
      }
      if (k == 0) continue;
      const double h = 1e-7, t = keys[k].seconds, v = keys[k].value;
      EXPECT_NEAR((value_at(keys, t + h) - v) / h, (v - value_at(keys, t - h)) / h, 0.2);
    }
  }
}

TEST(Keyframes, RotationsTakeTheShortestWayAtAConstantRate) {
  Keyframes<Affine> keys;
  set_key(keys, {0, rotated(350), Interpolation::linear});
  set_key(keys, {2, rotated(20), Interpolation::linear});
  EXPECT_TRUE(value_at(keys, 1).isApprox(rotated(5), 1e-14));
  EXPECT_TRUE(value_at(keys, 0.5).isApprox(rotated(357.5), 1e-14));
}

TEST(Keyframes, SmoothRotationsAboutOneAxisHaveAContinuousRate) {
  Keyframes<Affine> keys;
  for (int k = 0; k < 5; ++k) set_key(keys, {k * 1.0, rotated(80.0 * k), Interpolation::smooth});
  // Equal chords: between the ends the rate is constant.
  EXPECT_TRUE(value_at(keys, 1.25).isApprox(rotated(100), 1e-12));
  EXPECT_TRUE(value_at(keys, 2.5).isApprox(rotated(200), 1e-12));
  for (double t = 0; t <= 4; t += 0.1) {
    const Mat3 turn = value_at(keys, t).linear();
    EXPECT_NEAR((turn.transpose() * turn - Mat3::Identity()).norm(), 0, 1e-14);
  }
}

TEST(Keyframes, TinyRotationsStayExact) {
  Keyframes<Affine> keys;
  set_key(keys, {0, rotated(0), Interpolation::linear});
  set_key(keys, {1, rotated(1e-9), Interpolation::linear});
  EXPECT_NEAR(value_at(keys, 0.5).linear()(0, 2), 0.5e-9 * std::numbers::pi / 180, 1e-25);
}

TEST(Keyframes, StretchesAndMirrorsAreKept) {
  Affine mirrored = rotated(40);
  mirrored.linear() *= Vec3(-1, 2, 3).asDiagonal();
  Affine larger = rotated(40);
  larger.linear() *= Vec3(-2, 4, 6).asDiagonal();
  Keyframes<Affine> keys;
  set_key(keys, {0, mirrored, Interpolation::linear});
  set_key(keys, {1, larger, Interpolation::linear});
  EXPECT_TRUE(value_at(keys, 0.5).linear().isApprox(1.5 * mirrored.linear(), 1e-13));
  set_key(keys, {2, rotated(0), Interpolation::linear});
  EXPECT_THROW(value_at(keys, 1.5), Error);
  set_key(keys, {1, larger, Interpolation::step});
  EXPECT_TRUE(value_at(keys, 1.5).isApprox(larger));
}

TEST(Keyframes, CamerasStayOnTheirOrbit) {
  Keyframes<Camera> keys;
  for (int k = 0; k < 4; ++k) {
    Camera camera;
    camera.target = {1, 2, 3};
    camera.eye = camera.target + Eigen::AngleAxisd(k * std::numbers::pi / 2, Vec3::UnitY()) * Vec3(0, 3, 4);
    set_key(keys, {k * 1.0, camera, Interpolation::smooth});
  }
  for (double t = 0; t <= 3; t += 0.05) {
    const Camera at = value_at(keys, t);
    EXPECT_NEAR((at.eye - at.target).norm(), 5, 1e-12);
    EXPECT_TRUE(at.target.isApprox(Vec3(1, 2, 3), 1e-13));
  }
  EXPECT_EQ(value_at(keys, 2), keys[2].value);
}

TEST(Keyframes, HorizonsStayLevel) {
  Keyframes<Camera> keys;
  for (const Vec3& eye : {Vec3(0, 1, 4), Vec3(3, 5, 1), Vec3(-2, -1, -3)}) {
    Camera camera;
    camera.eye = eye;
    set_key(keys, {static_cast<double>(keys.size()), camera, Interpolation::smooth});
  }
  for (double t = 0; t <= 2; t += 0.01) {
    const Camera at = value_at(keys, t);
    EXPECT_TRUE(at.up.isApprox(Vec3::UnitY(), 1e-14));
    EXPECT_NEAR(world_to_camera(at).row(0).y(), 0, 1e-14) << "the right direction is horizontal";
  }
}

TEST(Keyframes, CamerasAccelerateByFactorsOfTheDistance) {
  Keyframes<Camera> keys;
  Camera camera;
  camera.eye = {0, 0, 1};
  set_key(keys, {0, camera, Interpolation::linear});
  camera.eye = {0, 0, 100};
  set_key(keys, {1, camera, Interpolation::linear});
  EXPECT_NEAR(value_at(keys, 0.5).eye.z(), 10, 1e-12);
}

}  // namespace
}  // namespace rebake::test
