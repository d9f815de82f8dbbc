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
  // White in the brightest photograph.
  for (std::size_t k = 0; k < photographs.size(); ++k) recolour(photographs[k], static_cast<std::uint8_t>(160 + 5 * k));
  frame = object_frame(photographs, Vec3::Ones(), 0);
  EXPECT_EQ(frame.background, Vec3::Ones());
  ASSERT_EQ(frame.gains.size(), photographs.size());
  EXPECT_NEAR(frame.gains[2].x(), to_linear(170 / 255.0), 1e-12);
  EXPECT_LT(half_of_cube(frame), 0.6);
}

TEST(CaptureFrame, GreyBackdropsAreTheBackgroundAndDarkOnesTellNoExposure) {
  const auto with_borders = [](int first, int step) {
    auto photographs = ball_photographs(20, 48);
    for (std::size_t k = 0; k < photographs.size(); ++k)
      for (std::size_t p = 0; p < photographs[k].rgb.size(); p += 3)
        if (photographs[k].rgb[p] == 255)
          std::fill_n(&photographs[k].rgb[p], 3, static_cast<std::uint8_t>(first + step * static_cast<int>(k)));
    return object_frame(photographs, Vec3::Ones(), 0);
  };
  const CaptureFrame grey = with_borders(110, 2);
  ASSERT_EQ(grey.gains.size(), 20U);
  EXPECT_NEAR(grey.background.x(), 129 / 255.0, 0.01);
  Vec3 logs = Vec3::Zero();
  for (const Vec3& gain : grey.gains) logs += gain.array().log().matrix();
  EXPECT_LT(logs.norm(), 1e-9);
  const CaptureFrame dark = with_borders(0, 1);
  EXPECT_TRUE(dark.gains.empty());
  EXPECT_LT(dark.background.maxCoeff(), 0.08);
}

TEST(CaptureFrame, APhotographIsEnoughAndNoneIsNot) {
  EXPECT_GT(half_of_cube(object_frame(ball_photographs(1, 48), Vec3::Ones(), 0)), 0.4);
  EXPECT_THROW(object_frame({}, Vec3::Ones(), 0), Error);
}

namespace {

// Cameras on a square of side 0.4 that look along −z, turned and moved as a whole.
std::vector<FitPhotograph> forward_photographs(const Affine& moved) {
  std::vector<FitPhotograph> photographs = ball_photographs(9, 16);
  for (int k = 0; k < 9; ++k) {
    Camera& camera = photographs[static_cast<std::size_t>(k)].camera;
    const Vec3 eye(0.2 * (k % 3 - 1), 0.2 * (k / 3 - 1), 0.1 * (k % 2));
    camera.eye = moved * eye;
    camera.target = moved * (eye - Vec3(0, 0, 5));
    camera.up = moved.linear() * Vec3::UnitY();
    camera.near_plane = 2;
    camera.far_plane = 20;
  }
  return photographs;
}

}  // namespace

TEST(CaptureFrame, ForwardCapturesLookAlongMinusZFromTheMeanPose) {
  const Affine moved = Eigen::Translation3d(7, -3, 2) * Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized());
  const auto photographs = forward_photographs(moved);
  const CaptureFrame frame = forward_frame(photographs, 0, 0);
  // Scaled by 4/3 / 2.
  EXPECT_LT((frame.to_unit * (moved * Vec3(0, 0, 0.4 / 9)) - Vec3::Zero()).norm(), 1e-9);
  EXPECT_LT((frame.to_unit * (moved * Vec3(0.6, 0.3, 0.4 / 9 - 2)) - Vec3(0.4, 0.2, -4.0 / 3)).norm(), 1e-9);
  EXPECT_NEAR(frame.frustum.farthest, 1.1 * 20 * 2 / 3, 1e-9);
  // All that photographs see from the nearest depth on lies in the grid.
  const GridSpace space(CaptureKind::forward, 16, 0, frame.frustum);
  for (const FitPhotograph& one : photographs)
    for (const double depth : {2.2, 5.0, 15.0})
      for (int corner = 0; corner < 4; ++corner) {
        const double tangent = 0.999 * std::tan(one.camera.fov_degrees * std::numbers::pi / 360);
        const Vec3 ray((corner % 2 * 2 - 1) * tangent, (corner / 2 * 2 - 1) * tangent, -1);
        const Vec3 cells =
            space.to_cells(frame.to_unit * (one.camera.eye + depth * world_to_camera(one.camera).transpose() * ray));
        for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(cells[axis] >= 0 && cells[axis] <= 16) << cells.transpose();
      }
  EXPECT_THROW(forward_frame(ball_photographs(20, 8), 1, 2), Error);
}

TEST(CaptureFrame, DepthsThatNobodyStatesAreAssumedWithAWarning) {
  auto photographs = forward_photographs(Affine::Identity());
  for (FitPhotograph& one : photographs) one.camera.near_plane = one.camera.far_plane = 0;
  EXPECT_NE(forward_frame(photographs, 0, 0).notes.front().find("give near and far"), std::string::npos);
  EXPECT_EQ(forward_frame(photographs, 1, 30).notes.front().find("give near and far"), std::string::npos);
}

TEST(CaptureFrame, UnboundedScenesHaveTheCamerasInTheCube) {
  const auto photographs = ball_photographs(20, 8);
  const CaptureFrame frame = unbounded_frame(photographs);
  double farthest = 0;
  for (const FitPhotograph& one : photographs)
    farthest = std::max(farthest, (frame.to_unit * one.camera.eye).cwiseAbs().maxCoeff());
  EXPECT_NEAR(farthest, 1, 1e-12);
  EXPECT_GT((frame.to_unit.linear() * Vec3::UnitY()).normalized().z(), 0.99);
  auto same = photographs;
  for (FitPhotograph& one : same) one.camera.eye = Vec3(1, 2, 3);
  EXPECT_THROW(unbounded_frame(same), Error);
}
