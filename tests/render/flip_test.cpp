// FLIP: known values, order of differences, and what observers do not see.
#include "render/flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "mesh_ops/base/error.h"

namespace rebake::test {
namespace {

Image uniform(std::uint8_t red, std::uint8_t green, std::uint8_t blue, int side = 24) {
  Image image{side, side, {}, {}};
  for (int p = 0; p < side * side; ++p) image.rgb.insert(image.rgb.end(), {red, green, blue});
  return image;
}
double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// HyAB of black and white is 100, and that of green and blue 203.3 after the Hunt effect: (100^0.7 − 0.4 · 203.3^0.7) /
// (0.6 · 203.3^0.7) of the last 5 %.
TEST(Flip, UniformPicturesHaveTheValueOfTheFormula) {
  for (const double error : flip_map(uniform(0, 0, 0), uniform(255, 255, 255))) EXPECT_NEAR(error, 0.9674, 2e-4);
  for (const double error : flip_map(uniform(0, 255, 0), uniform(0, 0, 255))) EXPECT_NEAR(error, 1, 1e-9);
  for (const double error : flip_map(uniform(9, 80, 200), uniform(9, 80, 200))) EXPECT_EQ(error, 0);
}

TEST(Flip, LiesBetweenZeroAndOneAndIsSymmetric) {
  std::mt19937 random(3);
  Image a = uniform(0, 0, 0), b = a;
  for (Image* image : {&a, &b})
    for (std::uint8_t& value : image->rgb) value = static_cast<std::uint8_t>(random() % 256);
  const std::vector<double> there = flip_map(a, b), back = flip_map(b, a);
  EXPECT_GE(*std::min_element(there.begin(), there.end()), 0);
  EXPECT_LE(*std::max_element(there.begin(), there.end()), 1);
  for (std::size_t p = 0; p < there.size(); ++p) EXPECT_NEAR(there[p], back[p], 1e-12);
}

// Two pictures with the same squared error: a fine checkerboard is seen less than a step, and less from far away.
TEST(Flip, FineNoiseIsSeenLessThanAnEdge) {
  const Image grey = uniform(128, 128, 128, 48);
  Image fine = grey, edge = grey;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 48; ++x)
      for (int c = 0; c < 3; ++c) {
        const auto at = static_cast<std::size_t>(3 * (48 * y + x) + c);
        fine.rgb[at] = static_cast<std::uint8_t>((x + y) % 2 == 0 ? 120 : 136);
        edge.rgb[at] = static_cast<std::uint8_t>(x < 24 ? 120 : 136);
      }
  EXPECT_LT(mean(flip_map(grey, fine)), 0.8 * mean(flip_map(grey, edge)));
  EXPECT_LT(mean(flip_map(grey, fine, 120)), mean(flip_map(grey, fine, 30)));
}

TEST(Flip, RefusesPicturesOfOtherSizes) { EXPECT_THROW(flip_map(uniform(0, 0, 0), uniform(0, 0, 0, 8)), Error); }

}  // namespace
}  // namespace rebake::test
