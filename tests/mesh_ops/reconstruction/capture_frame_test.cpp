#include "mesh_ops/reconstruction/capture_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mesh_ops/base/error.h"
#include "mesh_ops/scene/scene_light.h"
#include "tests/support/ball_photographs.h"

using namespace rebake;

namespace {

// Half the side of the cube in the scene.
double half_of_cube(const CaptureFrame& frame) { return 1 / frame.to_unit.linear()(0, 0); }

}  // namespace

TEST(CaptureFrame, ObjectsAreFramedBySilhouettes) {
  const CaptureFrame frame = object_frame(ball_photographs(20, 48), Vec3::Ones(), 0);
  EXPECT_GT(half_of_cube(frame), 0.5);  // the ball's radius
  EXPECT_LT(half_of_cube(frame), 0.6);
  EXPECT_LT((frame.to_unit * Vec3::Zero()).norm(), 0.1);
  EXPECT_NE(frame.notes.front().find("silhouettes"), std::string::npos);
}

TEST(CaptureFrame, MarginStaysFree) {
  const auto photographs = ball_photographs(20, 48);
  EXPECT_NEAR(half_of_cube(object_frame(photographs, Vec3::Ones(), 0.1)) /
                  half_of_cube(object_frame(photographs, Vec3::Ones(), 0)),
              1 / 0.8, 1e-12);
}

TEST(CaptureFrame, WithoutEvenBackgroundTheCubeIsWhatCamerasSee) {
  auto photographs = ball_photographs(20, 48);
  for (std::size_t x = 0; x < 48; ++x) photographs[3].rgb[3 * x] = static_cast<std::uint8_t>(5 * x);
  const CaptureFrame frame = object_frame(photographs, Vec3::Ones(), 0);
  EXPECT_NEAR(half_of_cube(frame), 2 * std::tan(19.5 * std::numbers::pi / 180), 1e-6);
  EXPECT_NE(frame.notes.front().find("no even background"), std::string::npos);
}

TEST(CaptureFrame, AnEvenBackgroundIsFoundUnlessExposuresDiffer) {
  auto photographs = ball_photographs(20, 48);
  const auto recolour = [](FitPhotograph& photograph, std::uint8_t value) {
    for (std::size_t k = 0; k < photograph.rgb.size(); k += 3)
      if (photograph.rgb[k] == 255) std::fill_n(&photograph.rgb[k], 3, value);
  };
  for (FitPhotograph& photograph : photographs) recolour(photograph, 0);
  CaptureFrame frame = object_frame(photographs, Vec3::Ones(), 0);
  EXPECT_EQ(frame.background, Vec3::Zero());
  EXPECT_LT(half_of_cube(frame), 0.6);
  photographs = ball_photographs(20, 48);
  for (std::size_t k = 0; k < photographs.size(); ++k) recolour(photographs[k], static_cast<std::uint8_t>(150 + 5 * k));
  frame = object_frame(photographs, Vec3::Ones(), 0);
  EXPECT_EQ(frame.background, Vec3::Ones());
  ASSERT_EQ(frame.gains.size(), photographs.size());
  EXPECT_NEAR(frame.gains[2].x(), to_linear(160 / 255.0), 1e-12);
  EXPECT_LT(half_of_cube(frame), 0.6);
}

TEST(CaptureFrame, APhotographIsEnoughAndNoneIsNot) {
  EXPECT_GT(half_of_cube(object_frame(ball_photographs(1, 48), Vec3::Ones(), 0)), 0.4);
  EXPECT_THROW(object_frame({}, Vec3::Ones(), 0), Error);
}
