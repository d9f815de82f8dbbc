// Local rotations are orthogonal for any matrix and equal the polar factor if that is defined.
#include "mesh_ops/base/polar.h"

#include <gtest/gtest.h>

#include <random>

namespace rebake::test {
namespace {

Mat3 random_matrix(std::mt19937& random) {
  std::normal_distribution<double> any;
  Mat3 m;
  for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = any(random);
  return m;
}

void expect_rotation(const Mat3& r) {
  EXPECT_LE((r.transpose() * r - Mat3::Identity()).norm(), 1e-14);
  EXPECT_GT(r.determinant(), 0);
}

TEST(LocalRotation, RotationForEveryMatrix) {
  std::mt19937 random(1);
  for (int k = 0; k < 2000; ++k) {
    Mat3 m = random_matrix(random);
    if (k % 4 == 1) m.col(0) = m.col(1) * 2 - m.col(2);                              // rank 2
    if (k % 4 == 2) m = m.col(0) * m.row(0);                                         // rank 1
    if (k % 4 == 3) m.col(2) = -m.col(0).cross(m.col(1)) * std::pow(10.0, -k % 20);  // mirrored, and nearly flat
    for (const double scale : {1.0, 1e-150, 1e150}) expect_rotation(local_rotation(m * scale).rotation);
  }
  for (const Mat3& m : {Mat3(Mat3::Zero()), Mat3(-Mat3::Identity()), Mat3(Mat3::Constant(std::nan("")))}) {
    expect_rotation(local_rotation(m).rotation);
    EXPECT_FALSE(local_rotation(m).defined);
  }
  EXPECT_TRUE(local_rotation(Mat3::Identity()).rotation.isIdentity(0));
}

TEST(LocalRotation, NewtonAndSingularValuesAgree) {
  std::mt19937 random(2);
  double worst = 0;
  for (int k = 0; k < 2000; ++k) {
    Mat3 m = random_matrix(random);
    if (m.determinant() < 0) m.col(0) = -m.col(0);
    if (m.determinant() < 1e-2 * std::pow(m.norm(), 3)) continue;
    worst = std::max(worst, (newton_polar_factor(m) - svd_rotation(m).rotation).norm());
  }
  EXPECT_LE(worst, 1e-13);
}

TEST(LocalRotation, RecoversTheRotationOfAStretch) {
  std::mt19937 random(3);
  for (int k = 0; k < 500; ++k) {
    const Mat3 r = Eigen::AngleAxisd(k * 0.0126, random_matrix(random).col(0).normalized()).toRotationMatrix();
    const Mat3 half = random_matrix(random);
    const Mat3 stretch = half * half.transpose() + 0.1 * Mat3::Identity();
    EXPECT_LE((local_rotation(r * stretch).rotation - r).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace rebake::test
