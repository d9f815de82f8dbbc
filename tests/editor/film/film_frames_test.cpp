// Where the camera of a film goes.
#include "editor/film/film_frames.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/cameras/camera_path_json.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

Camera looking_from(const Vec3& eye) {
  Camera camera;
  camera.eye = eye;
  return camera;
}

std::vector<FilmFrame> frames(const Scene& scene, const FilmPath& path) {
  double fps = 0;
  std::vector<std::string> notes;
  return film_frames(scene, path, fps, notes);
}

TEST(FilmFrames, ViewsAreReachedOnArcsAtEqualTimes) {
  const Camera first = looking_from({0, 0, 5}), second = looking_from({5, 0, 0}), third = looking_from({0, 5, 1e-3});
  const std::vector<Camera> path = cameras_through({first, second, third}, 21);
  ASSERT_EQ(path.size(), 21U);
  EXPECT_EQ(path[0], first);
  EXPECT_EQ(path[10], second);
  EXPECT_EQ(path[20], third);
  for (std::size_t k = 0; k < 20; ++k) {
    EXPECT_NEAR(path[k].eye.norm(), 5, 1e-6) << "the path must keep the orbit distance";
    EXPECT_LT((path[k + 1].eye - path[k].eye).norm(), 1.5) << "no jumps";
  }
  EXPECT_EQ(cameras_through({first}, 3).back(), first);
}

TEST(FilmFrames, LoopsDoNotShowTheirFirstPictureTwice) {
  Scene scene;
  scene.views["view 2"] = looking_from({5, 0, 0});
  scene.views["view 10"] = looking_from({0, 0, 5});
  const auto once = frames(scene, {.path = "views", .fps = 10}),
             loop = frames(scene, {.path = "views", .fps = 10, .loop = true});
  ASSERT_EQ(once.size(), 21U);
  EXPECT_EQ(once.front().camera, scene.views["view 2"]);  // natural order
  EXPECT_EQ(once.back().camera, scene.views["view 10"]);
  ASSERT_EQ(loop.size(), 40U);
  EXPECT_EQ(loop[20].camera, scene.views["view 10"]);
  EXPECT_NE(loop.back().camera.eye, loop.front().camera.eye);
}

TEST(FilmFrames, TurntablesKeepDistanceAndHeight) {
  FilmPath path{.path = "turntable", .fps = 4, .seconds = 2, .start = looking_from({3, 2, 4})};
  const auto around = frames({}, path);
  ASSERT_EQ(around.size(), 8U);
  EXPECT_EQ(around[0].camera, path.start);
  EXPECT_TRUE(around[4].camera.eye.isApprox(Vec3(-3, 2, -4), 1e-14));
}

TEST(FilmFrames, CameraPathsOfNerfstudioGiveEveryPicture) {
  const TemporaryFolder folder;
  std::vector<PhotoCamera> cameras;
  for (int k = 0; k < 5; ++k) cameras.push_back(photo_camera(looking_from({1.0 * k, 0, 5}), "", 100, 50));
  write_text(folder.path() / "camera_path.json", nerfstudio_path_text(cameras));
  double fps = 0;
  std::vector<std::string> notes;
  const std::string file = (folder.path() / "camera_path.json").string();
  const auto read = film_frames({}, {.path = file}, fps, notes);
  ASSERT_EQ(read.size(), 5U);
  EXPECT_EQ(fps, 24);
  EXPECT_TRUE(read[3].camera.eye.isApprox(Vec3(3, 5, 0), 1e-12));  // z points up in such files
  EXPECT_NEAR(read[1].seconds, 1.0 / 24, 1e-15);
  EXPECT_THROW(frames({}, {.path = file, .seconds = 3}), FieldError);
}

TEST(FilmFrames, RefusesWhatMakesNoFilm) {
  EXPECT_THROW(frames({}, {.path = "keys"}), FieldError);
  EXPECT_THROW(frames({}, {.path = "views"}), FieldError);
  EXPECT_THROW(frames({}, {.path = "turntable", .fps = 0}), FieldError);
  EXPECT_THROW(frames({}, {.path = "turntable", .fps = 1000, .seconds = 1e5}), FieldError);
  EXPECT_THROW(frames({}, {.path = "/no/such.json"}), FileError);
}

}  // namespace
}  // namespace rebake::test
