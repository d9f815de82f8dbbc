// Spherical harmonics against closed forms and quadrature.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "mesh_ops/light/transport/rotated_product.h"
#include "mesh_ops/light/transport/spherical_harmonics.h"

namespace rebake::test {
namespace {

using std::numbers::pi;

// Nodes and weights of a product rule that is exact for polynomials up to degree 15 on the sphere: Gauss–Legendre over
// z, equal steps around.
template <class Visit>
void for_sphere(Visit visit) {
  const Eigen::VectorXd nodes = [] {
    // Eigenvalues of the Jacobi matrix (Golub and Welsch 1969).
    Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(8, 8);
    for (int k = 1; k < 8; ++k) jacobi(k, k - 1) = jacobi(k - 1, k) = k / std::sqrt(4.0 * k * k - 1);
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(jacobi).eigenvalues();
  }();
  for (int i = 0; i < 8; ++i) {
    const double z = nodes[i];
    // 2 / ((1 − z²) P₈′(z)²)
    double below = 1, p = z;
    for (int k = 2; k <= 8; ++k) {
      const double next = ((2 * k - 1) * z * p - (k - 1) * below) / k;
      below = p;
      p = next;
    }
    const double slope = 8 * (z * p - below) / (z * z - 1), weight = 2 / ((1 - z * z) * slope * slope);
    for (int k = 0; k < 16; ++k) {
      const double phi = 2 * pi * k / 16, r = std::sqrt(1 - z * z);
      visit(Vec3(r * std::cos(phi), r * std::sin(phi), z), weight * 2 * pi / 16);
    }
  }
}

Mat3 some_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized()
      .toRotationMatrix();
}

TEST(SphericalHarmonics, AreOrthonormal) {
  Eigen::Matrix<double, sh::count, sh::count> products = decltype(products)::Zero();
  for_sphere([&](const Vec3& d, double weight) { products += weight * sh::basis(d) * sh::basis(d).transpose(); });
  EXPECT_LT((products - decltype(products)::Identity()).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(SphericalHarmonics, MatchClosedFormsAtThePole) {
  const sh::Coefficients up = sh::basis({0, 0, 1});
  for (int l = 0; l < sh::degrees; ++l)
    for (int m = -l; m <= l; ++m)
      EXPECT_NEAR(up[l * (l + 1) + m], m == 0 ? std::sqrt((2 * l + 1) / (4 * pi)) : 0, 1e-15);
  // Parity.
  const Vec3 d = Vec3(0.3, -0.5, 0.8).normalized();
  for (int l = 0; l < sh::degrees; ++l)
    for (int k = l * l; k < (l + 1) * (l + 1); ++k)
      EXPECT_DOUBLE_EQ(sh::basis(-d)[k], (l % 2 == 0 ? 1 : -1) * sh::basis(d)[k]);
}

TEST(SphericalHarmonics, ClampedCosineMatchesTheClosedForm) {
  // Zonal coefficients are integrals over the hemisphere: with z = cos θ, ∫₀¹ z P_l(z) dz = 1/2, 1/3, 1/8, 0.
  const sh::Coefficients lobe = sh::clamped_cosine({0, 0, 1});
  const double integral[] = {1.0 / 2, 1.0 / 3, 1.0 / 8, 0};
  for (int l = 0; l < sh::degrees; ++l)
    EXPECT_NEAR(lobe[l * (l + 1)], 2 * integral[l] * std::sqrt((2 * l + 1) / (4 * pi)), 1e-15) << l;
  // A uniform sky gives its own radiance for any normal.
  sh::Coefficients uniform = sh::Coefficients::Zero();
  uniform[0] = 0.7 * std::sqrt(4 * pi);
  EXPECT_NEAR(sh::value(sh::convolved_with_cosine(uniform), Vec3(1, 2, 3).normalized()), 0.7, 1e-15);
}

TEST(SphericalHarmonics, RotationsRotateFunctions) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 50; ++round) {
    const Mat3 turn = some_rotation(random);
    sh::Coefficients c;
    for (double& value : c) value = normal(random);
    const sh::Coefficients turned = sh::Rotation(turn) * c;
    for (int k = 0; k < 20; ++k) {
      const Vec3 d = Vec3(normal(random), normal(random), normal(random)).normalized();
      EXPECT_NEAR(sh::value(turned, turn * d), sh::value(c, d), 1e-13);
    }
    EXPECT_NEAR(turned.norm(), c.norm(), 1e-13);
  }
}

TEST(SphericalHarmonics, RotationsCompose) {
  std::mt19937 random(4);
  for (int round = 0; round < 20; ++round) {
    const Mat3 a = some_rotation(random), b = some_rotation(random);
    for (int l = 0; l < sh::degrees; ++l)
      EXPECT_LT(
          (sh::Rotation(a * b).block(l) - sh::Rotation(a).block(l) * sh::Rotation(b).block(l)).cwiseAbs().maxCoeff(),
          1e-13);
  }
}

// Near the identity a rotation is determined by its small entries. For a rotation about z by angle a they are ± sin(m
// a), known to full precision.
TEST(SphericalHarmonics, TinyRotationsKeepTheirDigits) {
  for (const double angle : {1e-3, 1e-6, 1e-9, 1e-12, 1e-15}) {
    Mat3 turn = Mat3::Identity();
    turn(0, 1) = -std::sin(angle);
    turn(1, 0) = std::sin(angle);
    turn(0, 0) = turn(1, 1) = std::cos(angle);
    const sh::Rotation rotation(turn);
    for (int l = 1; l < sh::degrees; ++l)
      for (int m = 1; m <= l; ++m) {
        const double expected = std::sin(m * angle);
        EXPECT_NEAR(rotation.block(l)(l - m, l + m) / expected, 1, 1e-13) << "angle " << angle << " degree " << l;
        EXPECT_NEAR(rotation.block(l)(l + m, l - m) / expected, -1, 1e-13);
      }
  }
  EXPECT_TRUE((sh::Rotation(Mat3::Identity()).block(3) - Eigen::MatrixXd::Identity(7, 7)).isZero(1e-15));
}

TEST(SphericalHarmonics, ShearedMatricesRotateByTheirPolarFactor) {
  Mat3 sheared = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  sheared(0, 1) += 0.05;
  const sh::Rotation rotation(sheared);
  for (int l = 0; l < sh::degrees; ++l)
    EXPECT_LT((rotation.block(l) * rotation.block(l).transpose() - Eigen::MatrixXd::Identity(2 * l + 1, 2 * l + 1))
                  .cwiseAbs()
                  .maxCoeff(),
              1e-13);
  EXPECT_THROW(sh::Rotation{Mat3(Mat3::Zero())}, std::invalid_argument);
  // For a mirroring M, value(c′, M d) = value(c, d) holds too.
  const Mat3 mirror = Vec3(-1, 1, 1).asDiagonal();
  sh::Coefficients c;
  for (int k = 0; k < sh::count; ++k) c[k] = std::sin(k + 1.0);
  const Vec3 d = Vec3(0.2, 0.5, -0.7).normalized();
  EXPECT_NEAR(sh::value(sh::Rotation(mirror) * c, mirror * d), sh::value(c, d), 1e-14);
}

// Windows lower the peak of a cosine lobe by 2 to 3 % and flatten the negative ringing behind it.
TEST(SphericalHarmonics, WindowsReduceRinging) {
  const auto deepest = [](const sh::Coefficients& c) {
    double least = 1e9;
    for (int k = 0; k <= 180; ++k)
      least = std::min(least, sh::value(c, Vec3(std::sin(k * pi / 180), 0, std::cos(k * pi / 180))));
    return least;
  };
  const sh::Coefficients spike = sh::basis({0, 0, 1});
  EXPECT_LT(deepest(spike), -0.05);
  for (const sh::Window window : {sh::Window::hann, sh::Window::lanczos}) {
    const sh::Coefficients softer = sh::windowed(spike, window);
    EXPECT_GT(deepest(softer), 0.5 * deepest(spike));
    EXPECT_EQ(softer[0], spike[0]);
  }
  EXPECT_EQ(sh::windowed(spike, sh::Window::none), spike);
}

TEST(SphericalHarmonics, ProductsWithRotatedTransferMatchTheMatrix) {
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  const auto some = [&] {
    sh::Coefficients c;
    for (double& value : c) value = normal(random);
    return c;
  };
  const std::array<sh::Coefficients, 3> radiance{some(), some(), some()};
  const RotatedProduct product(radiance);
  std::vector<Mat3> turns{Mat3::Identity(), Vec3(-1, 1, -1).asDiagonal().toDenseMatrix()};
  for (const double tiny : {1e-12, 1e-6})
    turns.push_back(Eigen::AngleAxisd(tiny, Vec3(1, 2, 3).normalized()).toRotationMatrix());
  for (int k = 0; k < 20; ++k) turns.push_back(some_rotation(random));
  for (const Mat3& turn : turns) {
    const sh::Coefficients transfer = some(), turned = sh::Rotation(turn) * transfer;
    const Radiance sum = product(turn, transfer);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], turned.dot(radiance[static_cast<std::size_t>(c)]), 1e-14 * 16);
  }
}

TEST(SphericalHarmonics, ProjectedSkyGivesItsIrradiance) {
  Light light = sky_and_sun({0.2, 0.3, 0.4}, {1, 0.9, 0.8}, {}, {0.1, 0.1, 0.1});
  const Mat3 to_light = Eigen::AngleAxisd(0.4, Vec3(1, 0, 1).normalized()).toRotationMatrix();
  const auto coefficients = projected_sky(light, to_light);
  // A sky that is linear in height has degrees 0 and 1 only: the mean, plus two thirds of its slope times height.
  const Vec3 normal = Vec3(0.3, 0.7, -0.2).normalized();
  const double height = (to_light * normal).y();
  for (int c = 0; c < 3; ++c) {
    const double below = Vec3(0.2, 0.3, 0.4)[c], above = Vec3(1, 0.9, 0.8)[c];
    const double expected = (below + above) / 2 + 2.0 / 3 * height * (above - below) / 2;
    EXPECT_NEAR(sh::clamped_cosine(normal).dot(coefficients[static_cast<std::size_t>(c)]) + 0.1, expected, 2e-3);
  }
}

}  // namespace
}  // namespace rebake::test
