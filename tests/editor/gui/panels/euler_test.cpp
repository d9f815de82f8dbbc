// Euler angles of the properties panel.
#include <gtest/gtest.h>

#include "editor/gui/panels/euler.h"

namespace rebake::test {
namespace {

TEST(Euler, AnglesRoundTripAndRightAnglesAreExact) {
  for (const Vec3& degrees : {Vec3(10, 20, 30), Vec3(-170, 80, 95), Vec3(179, -89.9, -179), Vec3(0, 0, 0)}) {
    EXPECT_LT((euler_degrees(rotation_of(degrees)) - degrees).norm(), 1e-11) << degrees.transpose();
    EXPECT_TRUE(rotation_of(degrees).isUnitary(1e-15));
  }
  EXPECT_EQ(rotation_of({90, 0, 0}) * Vec3::UnitY(), Vec3::UnitZ());
  EXPECT_EQ(rotation_of({90, 90, 0}) * Vec3::UnitY(), Vec3::UnitX()) << "about X first, then about Y";
  EXPECT_EQ(rotation_of({0, 180, 0}).diagonal(), Vec3(-1, 1, -1));
  // In gimbal lock the angles differ, but the rotation is the same.
  for (const double y : {90.0, -90.0}) {
    const Mat3 locked = rotation_of({25, y, 60});
    EXPECT_LT((rotation_of(euler_degrees(locked)) - locked).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace rebake::test
