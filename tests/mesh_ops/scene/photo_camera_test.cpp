// Cameras of photographs become views.
#include "mesh_ops/scene/photo_camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/cameras/photo_names.h"

namespace rebake::test {
namespace {

PhotoCamera looking_at(const Vec3& target, const Vec3& eye) {
  Camera view;
  view.eye = eye;
  view.target = target;
  return photo_camera(view, "", 64, 48);
}

TEST(PhotoCamera, ViewsLookAtWhereTheAxesMeet) {
  const Vec3 meeting(100.25, -3, 7);
  std::vector<PhotoCamera> cameras;
  for (const Vec3& from : {Vec3(5, 1, 2), Vec3(-3, 4, 0.5), Vec3(0.1, -2, 6)})
    cameras.push_back(looking_at(meeting, meeting + from));
  std::vector<std::string> notes;
  for (const Camera& view : views_of(cameras, notes)) EXPECT_LE((view.target - meeting).norm(), 1e-12);
  EXPECT_TRUE(notes.empty());
}

TEST(PhotoCamera, ParallelCamerasLookForward) {
  std::vector<PhotoCamera> cameras;
  for (const double x : {-1.0, 0.0, 1.0}) cameras.push_back(looking_at({x, 0, -5}, {x, 0, 5}));
  std::vector<std::string> notes;
  const std::vector<Camera> views = views_of(cameras, notes);
  for (std::size_t k = 0; k < views.size(); ++k) {
    EXPECT_GT((views[k].target - views[k].eye).norm(), 0.1);
    EXPECT_LE(((views[k].target - views[k].eye).normalized() + Vec3::UnitZ()).norm(), 1e-15);
  }
}

TEST(PhotoCamera, AxesThatMeetBehindACameraDoNotTurnIt) {
  // Two cameras back to back on one line, and one beside it.
  std::vector<PhotoCamera> cameras{looking_at({0, 0, -9}, {0, 0, -1}), looking_at({0, 0, 9}, {0, 0, 1}),
                                   looking_at({9, 0, 0}, {1, 0, 0})};
  std::vector<std::string> notes;
  const std::vector<Camera> views = views_of(cameras, notes);
  for (std::size_t k = 0; k < views.size(); ++k)
    EXPECT_LE(((views[k].target - views[k].eye).normalized() + cameras[k].axes.col(2)).norm(), 1e-14);
}

TEST(PhotoCamera, PanoramasKeepTheirDirections) {
  std::vector<PhotoCamera> cameras;
  const Vec3 eye(1.3, 0.7, 0.2);
  for (int k = 0; k < 8; ++k) cameras.push_back(looking_at(eye + Vec3(std::cos(k), 0.1 * k, std::sin(k)), eye));
  std::vector<std::string> notes;
  const std::vector<Camera> views = views_of(cameras, notes);
  for (std::size_t k = 0; k < views.size(); ++k)
    EXPECT_LE(((views[k].target - views[k].eye).normalized() + cameras[k].axes.col(2)).norm(), 1e-14);
}

TEST(PhotoCamera, DroppedPropertiesAreNoted) {
  PhotoCamera camera = looking_at({0, 0, 0}, {0, 0, 5});
  camera.center += Vec2(3, 4);
  camera.focal.x() *= 1.1;
  camera.distortion.radial[0] = 0.1;
  std::vector<std::string> notes;
  views_of({camera}, notes);
  ASSERT_EQ(notes.size(), 3U);
  EXPECT_NE(notes[1].find("5.0 pixels"), std::string::npos) << notes[1];
}

TEST(PhotoCamera, PixelsOfPoints) {
  PhotoCamera camera = looking_at({0, 0, 0}, {0, 0, 5});
  camera.focal = {100, 100};
  const auto pixel = [&](const Vec3& world) { return *pixel_of(camera, world); };
  EXPECT_EQ(pixel({0, 0, 0}), Vec2(32, 24));
  EXPECT_LE((pixel({1, 2, 0}) - Vec2(32 + 20, 24 - 40)).norm(), 1e-13) << "x right, y down";
  EXPECT_FALSE(pixel_of(camera, {0, 0, 5}));
  EXPECT_FALSE(pixel_of(camera, {0, 0, 6}));
}

TEST(PhotoCamera, LensDistortionIsThatOfOpenCv) {
  // The point (0.3, -0.2, 1) by the formulas in the documentation of OpenCV (calib3d).
  PhotoCamera camera = looking_at({0, 0, 0}, {0, 0, 5});
  camera.focal = {100, 110};
  camera.center = {50, 40};
  camera.distortion = {false, {0.1, -0.05, 0.01, 0}, {0.02, -0.03, 0.004}, {0.003, -0.002}};
  const Vec3 point = camera.eye + camera.axes * Vec3(0.3, 0.2, -1);
  const double r2 = 0.13, radial = (1 + 0.1 * r2 - 0.05 * r2 * r2 + 0.01 * r2 * r2 * r2) /
                                   (1 + 0.02 * r2 - 0.03 * r2 * r2 + 0.004 * r2 * r2 * r2);
  const double x = 0.3 * radial + 2 * 0.003 * 0.3 * -0.2 - 0.002 * (r2 + 2 * 0.09);
  const double y = -0.2 * radial + 0.003 * (r2 + 2 * 0.04) + 2 * -0.002 * 0.3 * -0.2;
  EXPECT_LE((*pixel_of(camera, point) - Vec2(50 + 100 * x, 40 + 110 * y)).norm(), 1e-13);
  camera.distortion = {true, {0.1, -0.05, 0.01, 0.02}, {}, {}};
  const double r = std::sqrt(r2), angle = std::atan(r), a2 = angle * angle;
  const double scale = angle * (1 + 0.1 * a2 - 0.05 * a2 * a2 + 0.01 * a2 * a2 * a2 + 0.02 * a2 * a2 * a2 * a2) / r;
  EXPECT_LE((*pixel_of(camera, point) - Vec2(50 + 30 * scale, 40 - 22 * scale)).norm(), 1e-13);
}

TEST(PhotoCamera, PointsBeyondTheFoldOfTheLensAreNowhere) {
  PhotoCamera camera = looking_at({0, 0, 0}, {0, 0, 5});
  camera.distortion.radial[0] = -0.3;  // grows until r = 1.054
  EXPECT_TRUE(pixel_of(camera, camera.eye + camera.axes * Vec3(1, 0, -1)));
  EXPECT_FALSE(pixel_of(camera, camera.eye + camera.axes * Vec3(1.8, 0, -1))) << "would appear at the centre";
}

TEST(PhotoCamera, FieldOfViewIsVertical) {
  PhotoCamera camera = looking_at({0, 0, 0}, {0, 0, 5});
  camera.focal = {1000, 24};
  std::vector<std::string> notes;
  EXPECT_NEAR(views_of({camera}, notes)[0].fov_degrees, 90, 1e-13);
}

TEST(PhotoCamera, PosesOfAnyScaleAreRotations) {
  const Mat3 rotation = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (const double scale : {1e-200, 0.33, 1.0, 1e200})
    EXPECT_LE((rotation_of_pose(rotation * scale, "pose") - rotation).norm(), 1e-14) << scale;
  Mat3 mirrored = rotation, sheared = rotation, stretched = rotation;
  mirrored.col(0) *= -1;
  sheared.col(0) += 0.01 * sheared.col(1);
  stretched.col(2) *= 1.01;
  for (const Mat3& bad : {mirrored, sheared, stretched, Mat3(Mat3::Zero()), Mat3(Mat3::Constant(NAN))})
    EXPECT_THROW(rotation_of_pose(bad, "pose"), FieldError) << bad;
}

TEST(PhotoCamera, WorldAxesAreInverse) {
  const std::vector<PhotoCamera> cameras{looking_at({1, 2, 3}, {4, 5, 7})};
  EXPECT_EQ(from_y_up(with_y_up(cameras, WorldUp::z), WorldUp::z), cameras);
  EXPECT_EQ(with_y_up(cameras, WorldUp::z)[0].eye, Vec3(4, 7, -5));
}

std::vector<std::string> names_of(const std::vector<std::string>& photographs) {
  std::vector<PhotoCamera> cameras;
  for (const std::string& name : photographs) cameras.emplace_back().name = name;
  return photo_names(cameras);
}

TEST(PhotoNames, AreUniqueFileNames) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(names_of({"images/a.jpg", "images/b.jpg"}), (Names{"a", "b"}));
  EXPECT_EQ(names_of({"left/a.jpg", "right/a.jpg"}), (Names{"left-a", "right-a"}));
  EXPECT_EQ(names_of({"a.jpg", "a.png"}), (Names{"a", "a 2"}));
  EXPECT_EQ(names_of({"", "..", "a/", "b\n.png"}), (Names{"camera 0", "camera 1", "camera 2", "b-"}));
  EXPECT_EQ(names_of({"caf\xe9.jpg"}), (Names{"caf\xef\xbf\xbd"}));
  EXPECT_TRUE(names_of({}).empty());
}

}  // namespace
}  // namespace rebake::test
