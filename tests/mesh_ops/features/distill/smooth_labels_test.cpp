// smooth_labels() compared with exhaustive search.
#include "mesh_ops/features/distill/smooth_labels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mesh_ops/training/feature_network.h"

namespace rebake::test {
namespace {

using Costs = std::vector<std::vector<double>>;

double sum_of(const Costs& costs, const std::vector<LabelBorder>& borders, const std::vector<std::uint32_t>& labels) {
  double sum = 0;
  for (std::size_t k = 0; k < costs.size(); ++k) sum += costs[k][labels[k]];
  for (const LabelBorder& border : borders)
    if (labels[border.a] != labels[border.b]) sum += border.cost;
  return sum;
}

TEST(SmoothLabels, NearMinimumOfExhaustiveSearch) {
  SplitMix64 dice(3);
  constexpr std::size_t things = 7, labels = 3;
  for (int round = 0; round < 40; ++round) {
    Costs costs(things, std::vector<double>(labels));
    for (auto& of_thing : costs)
      for (double& cost : of_thing) cost = dice.share();
    std::vector<LabelBorder> borders;
    for (std::uint32_t a = 0; a < things; ++a)
      for (std::uint32_t b = a + 1; b < things; ++b)
        if (dice.share() < 0.4) borders.push_back({a, b, dice.share()});
    double best = std::numeric_limits<double>::infinity();
    std::vector<std::uint32_t> tried(things);
    for (int code = 0; code < 2187; ++code) {  // 3⁷
      for (int k = 0, rest = code; k < static_cast<int>(things); ++k, rest /= 3)
        tried[static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(rest % 3);
      best = std::min(best, sum_of(costs, borders, tried));
    }
    const double found = sum_of(costs, borders, smooth_labels(costs, borders));
    EXPECT_GE(found, best - 1e-12);
    // The proven bound is a factor of 2; in practice the result is much closer to the minimum.
    EXPECT_LE(found, 1.2 * best);
  }
}

TEST(SmoothLabels, BorderCostsDecideBetweenOwnAndCommonLabels) {
  const Costs costs{{0.2, 0.1}, {0.1, 0.5}, {0.3, 0.4}};
  EXPECT_EQ(smooth_labels(costs, {}), (std::vector<std::uint32_t>{1, 0, 0}));
  EXPECT_EQ(smooth_labels(costs, {{0, 1, 9}, {1, 2, 9}}), (std::vector<std::uint32_t>{0, 0, 0}));
  EXPECT_EQ(smooth_labels(costs, {{0, 1, 0.05}, {1, 2, 0.05}}), (std::vector<std::uint32_t>{1, 0, 0}));
}

TEST(SmoothLabels, EmptyInputAndSingleLabel) {
  EXPECT_TRUE(smooth_labels({}, {}).empty());
  EXPECT_EQ(smooth_labels({{4}, {2}}, {{0, 1, 3}}), (std::vector<std::uint32_t>{0, 0}));
}

}  // namespace
}  // namespace rebake::test
