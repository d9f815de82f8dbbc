#include "mesh_ops/reconstruction/training_views.h"

#include <gtest/gtest.h>

#include <map>

#include "mesh_ops/base/error.h"
#include "mesh_ops/scene/photo_camera.h"
#include "mesh_ops/scene/scene_light.h"
#include "tests/support/ball_photographs.h"

using namespace rebake;

TEST(TrainingViews, PicksValidPixelsEvenly) {
  auto photographs = ball_photographs(2, 4);
  photographs[0].valid.assign(16, 0);
  photographs[0].valid[5] = photographs[0].valid[10] = 1;
  const TrainingViews views(photographs, Affine::Identity(), Axes::y_up);
  SplitMix64 dice(1);
  std::map<std::tuple<std::size_t, int, int>, int> counts;
  for (int k = 0; k < 18000; ++k) {
    const auto pixel = views.pick(dice);
    ++counts[{pixel.photograph, pixel.x, pixel.y}];
  }
  ASSERT_EQ(counts.size(), 18U);
  EXPECT_TRUE((counts.contains({0, 1, 1}) && counts.contains({0, 2, 2})));
  for (const auto& [pixel, count] : counts) EXPECT_NEAR(count, 1000, 150);
}

TEST(TrainingViews, RaysMeetTheirPixels) {
  const auto photographs = ball_photographs(3, 8);
  const Affine to_unit = Eigen::Scaling(0.5) * Eigen::Translation3d(1, 2, 3);
  const TrainingViews views(photographs, to_unit, Axes::y_up);
  for (std::size_t k = 0; k < photographs.size(); ++k) {
    const TrainingRay ray = views.ray(k, 2.5, 6.25);
    const Vec3 point = to_unit.inverse() * (ray.origin + 1.7 * ray.direction);
    const auto pixel = pixel_of(photo_camera(photographs[k].camera, "", 8, 8), point);
    ASSERT_TRUE(pixel);
    EXPECT_LT((*pixel - Vec2(2.5, 6.25)).norm(), 1e-9);
  }
}

TEST(TrainingViews, GainsAreRemovedInLinearLight) {
  auto photographs = ball_photographs(1, 2);
  photographs[0].rgb.assign(12, 100);
  TrainingViews views(photographs, Affine::Identity(), Axes::y_up);
  EXPECT_NEAR(views.color({0, 0, 0}).x(), 100 / 255.0, 1e-15);
  views.set_gain(0, Vec3(0.5, 1, 2));
  const Vec3 color = views.color({0, 0, 0});
  EXPECT_NEAR(to_linear(color.x()), 2 * to_linear(100 / 255.0), 1e-12);
  EXPECT_NEAR(color.y(), 100 / 255.0, 1e-15);
  EXPECT_NEAR(to_linear(color.z()), to_linear(100 / 255.0) / 2, 1e-12);
}

TEST(TrainingViews, RefusesPhotographsThatMasksLeaveOutWholly) {
  auto photographs = ball_photographs(2, 4);
  for (FitPhotograph& photograph : photographs) photograph.valid.assign(16, 0);
  EXPECT_THROW(TrainingViews(photographs, Affine::Identity(), Axes::y_up), Error);
}
