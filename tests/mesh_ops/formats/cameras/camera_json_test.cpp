// Cameras as values and as JSON.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/cameras/camera_json.h"

namespace rebake::test {
namespace {

TEST(Camera, JsonKeepsBothProjections) {
  Camera camera;
  camera.eye = {0.1, -2, 1.0 / 3};
  EXPECT_EQ(read_camera_json(camera_json(camera)), camera);
  EXPECT_FALSE(camera_json(camera).contains("ortho_height")) << "a perspective camera has no ortho_height";
  camera.ortho_height = 0.7;
  EXPECT_EQ(read_camera_json(camera_json(camera)), camera);
  EXPECT_TRUE(read_camera_json(camera_json(camera)).orthographic());
}

TEST(Camera, FitsMissingPlanesToTheScene) {
  const Camera open = read_camera_json({{"eye", {0, 0, 3000}}});
  EXPECT_FALSE(camera_json(open).contains("near"));
  EXPECT_EQ(read_camera_json(camera_json(open)), open);
  EXPECT_THROW(read_camera_json({{"near", 0}}), FieldError);
  EXPECT_THROW(read_camera_json({{"far", -1}}), FieldError);
  const Box box(Vec3(-100, -100, -100), Vec3(100, 100, 100));
  // From far away, from beside the box with a wide picture, and from inside; at three scales.
  for (const double scale : {1e-9, 1.0, 1e9})
    for (const Vec3& eye : {Vec3(0, 0, 3000), Vec3(120, 0, 150), Vec3(10, 20, 30)}) {
      Camera camera = open;
      camera.eye = eye * scale;
      camera.fov_degrees = 150;
      const Box scaled(box.min() * scale, box.max() * scale);
      const Camera fitted = with_planes(camera, scaled, 2);
      EXPECT_NO_THROW(check(fitted));
      double nearest = 1e300, farthest = 0;
      for (int k = 0; k < 8; ++k) {
        const double distance = (scaled.corner(static_cast<Box::CornerType>(k)) - camera.eye).norm();
        nearest = std::min(nearest, distance);
        farthest = std::max(farthest, distance);
      }
      EXPECT_LT(fitted.near_plane, nearest);
      EXPECT_LE(fitted.near_plane, std::max(scaled.exteriorDistance(camera.eye) / 2, farthest * 1e-3));
      EXPECT_GT(fitted.near_plane, 0);
      EXPECT_GE(fitted.far_plane, farthest);
    }
  // A given plane is not changed; the other one is fitted so that both are valid.
  Camera beyond = open, before = open;
  beyond.near_plane = 1e6;
  before.far_plane = 1e-3;
  EXPECT_EQ(with_planes(beyond, box, 1).near_plane, 1e6);
  EXPECT_NO_THROW(check(with_planes(beyond, box, 1)));
  EXPECT_EQ(with_planes(before, box, 1).far_plane, 1e-3);
  EXPECT_NO_THROW(check(with_planes(before, box, 1)));
  EXPECT_NO_THROW(check(with_planes(open, Box(), 1)));
  // The eye at a scene of one point; then an eye so far away that distances overflow.
  EXPECT_NO_THROW(check(with_planes(open, Box(open.eye, open.eye), 1)));
  Camera away = open;
  away.eye = Vec3(1e160, 0, 0);
  EXPECT_NO_THROW(check(with_planes(away, box, 1)));
  away.eye = Vec3(1.7e308, 1.7e308, 0);
  try {
    with_planes(away, box, 1);
    FAIL();
  } catch (const FieldError& error) {
    EXPECT_NE(std::string(error.what()).find("eye"), std::string::npos) << error.what();
  }
}

TEST(Camera, RejectsInvalidOrthoHeight) {
  for (const double height :
       {-1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    Camera camera;
    camera.ortho_height = height;
    EXPECT_THROW(check(camera), FieldError) << height;
  }
  EXPECT_THROW(read_camera_json({{"ortho_height", "high"}}), FieldError);
}

// With one plane given, at any power of ten, the other is fitted or the error names the given one.
TEST(Camera, ErrorsNameTheGivenPlane) {
  const Box scene(Vec3(-1, -1, -1), Vec3(1, 1, 1));
  int errors = 0;
  for (int power = -323; power <= 308; ++power)
    for (const bool near : {true, false})
      for (const Box& box : {scene, Box()}) {
        Camera camera;
        camera.near_plane = camera.far_plane = 0;
        (near ? camera.near_plane : camera.far_plane) = std::pow(10.0, power);
        try {
          const Camera fitted = with_planes(camera, box, 1);
          check(fitted);
          EXPECT_GT(fitted.near_plane, 0) << power;
        } catch (const FieldError& error) {
          ++errors;
          EXPECT_TRUE(std::string(error.what()).starts_with(near ? "field \"near\"" : "field \"far\"")) << power;
        }
      }
  EXPECT_LT(errors, 40);
}

}  // namespace
}  // namespace rebake::test
