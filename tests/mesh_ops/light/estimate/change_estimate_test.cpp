// ChangeEstimate: its bound on places that were not sampled holds with the stated confidence.
#include "mesh_ops/light/estimate/change_estimate.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace rebake::test {
namespace {

TEST(ChangeEstimate, TakesAllOfFewPlaces) {
  EXPECT_EQ(sample_places({1, 0, 1, 2}, 3), (std::vector<std::size_t>{0, 2, 3}));
  EXPECT_EQ((ChangeEstimate{0.5, 3, 3}).share_beyond(), 0);
}

TEST(ChangeEstimate, SamplesAreDistinctAndDeterministic) {
  const std::vector<std::uint8_t> places(1000, 1);
  const std::vector<std::size_t> picked = sample_places(places, 512);
  EXPECT_EQ(picked.size(), 512U);
  EXPECT_TRUE(std::is_sorted(picked.begin(), picked.end()));
  EXPECT_EQ(std::adjacent_find(picked.begin(), picked.end()), picked.end());
  EXPECT_EQ(picked, sample_places(places, 512));
}

// Over 3000 objects, the share of places that change more than the largest sampled change exceeds share_beyond() in
// about 1 % of cases.
TEST(ChangeEstimate, HoldsWithStatedConfidence) {
  constexpr std::size_t objects = 3000, picks = 64;
  std::size_t wrong = 0;
  for (std::size_t n = 0; n < objects; ++n) {
    const std::size_t count = 1000 + 7 * n;
    const std::vector<std::size_t> picked = sample_places(std::vector<std::uint8_t>(count, 1), picks);
    // The changes of the places are a permutation of 0 … count − 1.
    constexpr std::size_t prime = 1'000'003;
    std::size_t largest = 0;
    for (const std::size_t place : picked) largest = std::max(largest, place * prime % count);
    const double beyond = static_cast<double>(count - 1 - largest) / static_cast<double>(count);
    wrong += beyond > ChangeEstimate{0, picks, count}.share_beyond() ? 1 : 0;
  }
  EXPECT_LE(wrong, objects / 50);  // 30 expected; 60 is five standard deviations above
  EXPECT_GT(wrong, 0U);
}

}  // namespace
}  // namespace rebake::test
