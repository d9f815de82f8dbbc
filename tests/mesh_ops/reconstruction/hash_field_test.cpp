#include "mesh_ops/reconstruction/hash_field.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numeric>
#include <random>

using namespace rebake;

namespace {

constexpr HashFieldOptions small_field{
    .levels = 3, .coarsest = 3, .finest = 13, .log2_entries = 8, .hidden = 8, .bias = -1};

std::vector<FieldPoint> random_points(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<FieldPoint> points;
  for (std::size_t k = 0; k < count; ++k) points.push_back({unit(random), unit(random), unit(random)});
  return points;
}

// A field whose entries are large enough to matter: a step of Adam with random slopes.
HashField random_field(std::size_t outputs, std::uint64_t seed) {
  HashField field(outputs, small_field, seed);
  std::mt19937 random(static_cast<unsigned>(seed));
  std::normal_distribution<float> normal;
  const std::vector<FieldPoint> points = random_points(500);
  for (int k = 0; k < 3; ++k) {
    std::vector<float> slopes(points.size() * outputs);
    for (float& slope : slopes) slope = normal(random);
    field.backpropagate(points, slopes, nullptr);
    field.step(0.02);
  }
  return field;
}

double weighted_sum(const HashField& field, const std::vector<FieldPoint>& points, const std::vector<float>& slopes) {
  std::vector<float> values;
  field.evaluate(points, values);
  double sum = 0;
  for (std::size_t k = 0; k < values.size(); ++k) sum += double{values[k]} * double{slopes[k]};
  return sum;
}

}  // namespace

TEST(HashField, StartsAtItsBias) {
  const HashField field(1, {.log2_entries = 10, .bias = -8}, 1);
  std::vector<float> values;
  field.evaluate(random_points(100), values);
  for (const float value : values) EXPECT_NEAR(value, 1 / (1 + std::exp(8.0)), 1e-5);
}

TEST(HashField, PointSlopesMatchDifferences) {
  HashField field = random_field(2, 5);
  const std::vector<FieldPoint> points = random_points(300);
  std::vector<float> slopes(600);
  for (std::size_t k = 0; k < slopes.size(); ++k) slopes[k] = k % 2 == 0 ? 1.0F : -0.5F;
  std::vector<FieldPoint> found;
  field.backpropagate(points, slopes, &found);
  std::size_t kinks = 0;
  for (std::size_t p = 0; p < points.size(); ++p)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      constexpr float step = 1e-4F;
      const auto value = [&](float by) {
        FieldPoint moved = points[p];
        moved[axis] = std::clamp(moved[axis] + by, 0.0F, 1.0F);
        return weighted_sum(field, {moved}, {slopes[2 * p], slopes[2 * p + 1]});
      };
      const double wanted = (value(step) - value(-step)) / (2 * step);
      // Cells and ReLUs have kinks, where the difference lies between the slopes of both sides.
      if (std::abs(double{found[p][axis]} - wanted) > 2e-2 * (1 + std::abs(wanted))) ++kinks;
    }
  EXPECT_LT(kinks, 45U);  // of 900
}

TEST(HashField, GradientsPredictSmallChanges) {
  // A change of all entries along random directions changes the loss as the gradient says. The change is made by
  // loading edited bytes: entries are the first numbers of a saved field.
  HashField field = random_field(8, 9);
  const std::vector<FieldPoint> points = random_points(400);
  std::vector<float> slopes(points.size() * 8);
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  for (float& slope : slopes) slope = normal(random);
  field.backpropagate(points, slopes, nullptr);
  const std::vector<float> gradient = field.table_gradient();
  std::string saved;
  field.save(saved);
  for (int trial = 0; trial < 5; ++trial) {
    std::vector<float> direction(gradient.size());
    for (float& one : direction) one = normal(random);
    const auto moved = [&](float by) {
      std::string bytes = saved;
      for (std::size_t k = 0; k < direction.size(); ++k) {
        const float value = field.table()[k] + by * direction[k];
        std::memcpy(bytes.data() + 8 + 4 * k, &value, 4);
      }
      HashField other(8, small_field, 1);
      std::string_view rest = bytes;
      other.load(rest);
      return weighted_sum(other, points, slopes);
    };
    const double wanted = std::inner_product(gradient.begin(), gradient.end(), direction.begin(), 0.0);
    constexpr float step = 1e-4F;
    EXPECT_NEAR((moved(step) - moved(-step)) / (2 * step), wanted, 0.03 * std::abs(wanted) + 0.05);
  }
}

TEST(HashField, GivesTheSameBitsAtAnyNumberOfThreads) {
  std::vector<std::string> results;
  for (const std::size_t threads : {1, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const HashField field = random_field(8, 4);
    field.save(results.emplace_back());
  }
  EXPECT_EQ(results[0], results[1]);
}

TEST(HashField, RefusesBytesOfOtherSizes) {
  const HashField field(1, small_field, 1);
  std::string bytes;
  field.save(bytes);
  HashFieldOptions wider = small_field;
  wider.hidden = 16;
  HashField other(1, wider, 1);
  std::string_view rest = bytes;
  EXPECT_THROW(other.load(rest), Error);
  HashField same(1, small_field, 2);
  rest = std::string_view(bytes).substr(0, bytes.size() - 1);
  EXPECT_THROW(same.load(rest), Error);
}
