// Functions with the same bits on every processor (elementary.h) compared with 120-digit arithmetic.
#include "mesh_ops/base/elementary.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "tests/support/gold.h"

namespace rebake::test {
namespace {

// Error in units in the last place of the exact value.
double error_in_ulps(double got, const Gold& want) {
  const auto rounded = static_cast<double>(want);
  const double ulp = std::nextafter(std::abs(rounded), 1e300) - std::abs(rounded);
  return static_cast<double>(abs(Gold(got) - want)) / ulp;
}

TEST(Elementary, WithinTwoUnitsInTheLastPlace) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> exponent(-12, 12), angle(-400, 400), share(0, 1);
  double arctangent = 0, logarithm = 0, circular = 0, exponential = 0;
  for (int k = 0; k < 20000; ++k) {
    const double x = std::pow(10, exponent(random)) * (k % 2 == 0 ? 1 : -1),
                 y = k % 3 == 0 ? x * share(random) : std::pow(10, exponent(random)) * (k % 5 == 0 ? 1 : -1);
    arctangent = std::max(arctangent, error_in_ulps(elementary::atan2(y, x), atan2(Gold(y), Gold(x))));
    const double positive = k % 2 == 0 ? std::abs(x) : 0.5 + share(random);
    logarithm = std::max(logarithm, error_in_ulps(elementary::log(positive), log(Gold(positive))));
    const double power = k % 2 == 0 ? 1400 * (share(random) - 0.5) : share(random) - 0.5;
    exponential = std::max(exponential, error_in_ulps(elementary::exp(power), exp(Gold(power))));
    const double a = k % 4 == 0 ? 1e6 * (share(random) - 0.5) : k % 4 == 1 ? x * 1e-8 : angle(random);
    const auto [sine, cosine] = elementary::sine_cosine(a);
    circular = std::max({circular, error_in_ulps(sine, sin(Gold(a))), error_in_ulps(cosine, cos(Gold(a)))});
  }
  EXPECT_LE(arctangent, 2);
  EXPECT_LE(logarithm, 2);
  EXPECT_LE(circular, 2);
  EXPECT_LE(exponential, 2);
}

TEST(Elementary, AxesAndRightAnglesAreExact) {
  constexpr double pi = std::numbers::pi;
  EXPECT_EQ(elementary::atan2(0, 1), 0);
  EXPECT_EQ(elementary::atan2(0, 0), 0);
  EXPECT_EQ(elementary::atan2(1, 0), pi / 2);
  EXPECT_EQ(elementary::atan2(-1, 0), -pi / 2);
  EXPECT_EQ(elementary::atan2(0, -1), pi);
  EXPECT_EQ(elementary::atan2(1, 1), pi / 4);
  EXPECT_EQ(elementary::sine_cosine(0).sine, 0);
  EXPECT_EQ(elementary::sine_cosine(0).cosine, 1);
  EXPECT_EQ(elementary::sine_cosine(pi / 2).sine, 1);
  EXPECT_EQ(elementary::log(1), 0);
  EXPECT_EQ(elementary::exp(0), 1);
  EXPECT_EQ(elementary::exp(-800), 0);
  EXPECT_EQ(elementary::exp(800), HUGE_VAL);
  EXPECT_TRUE(std::isnan(elementary::exp(std::nan(""))));
}

}  // namespace
}  // namespace rebake::test
