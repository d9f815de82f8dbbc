// Cameras as values and as JSON.
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/camera_json.h"

namespace rebake::test {
namespace {

TEST(Camera, JsonKeepsBothProjections) {
  Camera camera;
  camera.eye = {0.1, -2, 1.0 / 3};
  EXPECT_EQ(read_camera_json(camera_json(camera)), camera);
  EXPECT_FALSE(camera_json(camera).contains("ortho_height")) << "of a pinhole it says nothing";
  camera.ortho_height = 0.7;
  EXPECT_EQ(read_camera_json(camera_json(camera)), camera);
  EXPECT_TRUE(read_camera_json(camera_json(camera)).orthographic());
}

TEST(Camera, AHeightThatShowsNothingIsRefused) {
  for (const double height :
       {-1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    Camera camera;
    camera.ortho_height = height;
    EXPECT_THROW(check(camera), FieldError) << height;
  }
  EXPECT_THROW(read_camera_json({{"ortho_height", "high"}}), FieldError);
}

}  // namespace
}  // namespace rebake::test
