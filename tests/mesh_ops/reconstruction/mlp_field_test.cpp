#include "mesh_ops/reconstruction/mlp_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "mesh_ops/base/error.h"

using namespace rebake;

namespace {

constexpr MlpFieldSizes small_network{2, 16, 3, 6, 1, -2, 5};

bool has_module() {
  try {
    require_mlp_fields();
    return true;
  } catch (const Error&) {
    return false;
  }
}

std::vector<FieldPoint> points_in_cube(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<FieldPoint> points;
  for (std::size_t k = 0; k < count; ++k) points.push_back({unit(random), unit(random), unit(random)});
  return points;
}

}  // namespace

TEST(MlpField, PointSlopesMatchDifferences) {
  if (!has_module()) GTEST_SKIP() << "LibTorch is not installed";
  MlpField field(small_network);
  const std::vector<FieldPoint> points = points_in_cube(100);
  const std::vector<float> slopes(200, 1);
  std::vector<FieldPoint> found;
  field.backpropagate(points, slopes, &found);
  int kinks = 0;
  for (std::size_t p = 0; p < points.size(); ++p)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      constexpr float step = 1e-3F;
      std::vector<FieldPoint> moved{points[p], points[p]};
      moved[0][axis] += step;
      moved[1][axis] -= step;
      std::vector<float> values;
      field.evaluate(moved, values);
      const double wanted = double{values[0] + values[1] - values[2] - values[3]} / (2 * double{step});
      if (std::abs(double{found[p][axis]} - wanted) > 0.02 * (0.1 + std::abs(wanted))) ++kinks;
    }
  EXPECT_LT(kinks, 15);  // of 300; ReLUs have kinks
}

TEST(MlpField, LearnsAndGoesOnFromASavedState) {
  if (!has_module()) GTEST_SKIP() << "LibTorch is not installed";
  MlpField field(small_network), other(small_network);
  const std::vector<FieldPoint> points = points_in_cube(200);
  const auto error_and_step = [&](MlpField& one) {
    std::vector<float> values, slopes;
    one.evaluate(points, values);
    double error = 0;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const float off = values[k] - (points[k / 2][k % 2] > 0.5F ? 0.9F : 0.1F);
      slopes.push_back(2 * off / 400);
      error += double{off} * double{off} / 400;
    }
    one.backpropagate(points, slopes, nullptr);
    one.step(0.01);
    return error;
  };
  const double before = error_and_step(field);
  for (int k = 0; k < 60; ++k) error_and_step(field);
  std::string state;
  field.save(state);
  std::string_view rest = state;
  other.load(rest);
  EXPECT_TRUE(rest.empty());
  double after = 0;
  for (int k = 0; k < 60; ++k) {
    after = error_and_step(field);
    EXPECT_EQ(error_and_step(other), after);
  }
  EXPECT_LT(after, before / 4);
  rest = std::string_view(state).substr(8);
  EXPECT_THROW(other.load(rest), Error);
}
