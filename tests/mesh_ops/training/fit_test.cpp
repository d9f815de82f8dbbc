// Joint fitting of features and decoder reaches 40 dB on its training data and is deterministic.
#include "mesh_ops/training/fit.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rebake::test {
namespace {

FitProblem problem(bool view_dependent) {
  FitProblem p{512, 16, {}, {}, {}};
  for (std::size_t t = 0; t < p.texel_count; ++t)
    for (std::size_t k = 0; k < p.observations_per_texel; ++k) {
      const auto angle = static_cast<float>(k) * 0.39F;
      p.fed_directions.push_back({std::cos(angle), std::sin(angle), 0});
      const float tone = static_cast<float>(t % 32) / 32,
                  shine = view_dependent ? 0.2F * std::max(0.0F, std::cos(angle)) : 0;
      p.colors.push_back({0.1F + 0.6F * tone + shine, 0.5F + shine, 0.7F - 0.5F * tone + shine});
    }
  return p;
}

TEST(Fit, ReachesFortyDecibels) {
  for (const bool view_dependent : {false, true}) {
    const FitResult result = fit(problem(view_dependent), {.epochs = 500});
    EXPECT_LT(result.quantised_mean_squared_error, 1e-4) << view_dependent;
    for (const auto& f : result.features) {
      EXPECT_GE(f[0], 1);  // 0 would be transparent
      EXPECT_GE(f[3], 128);
      EXPECT_GE(f[7], 128);
    }
  }
}

TEST(Fit, IsDeterministic) {
  const FitResult a = fit(problem(true), {.epochs = 3}), b = fit(problem(true), {.epochs = 3});
  EXPECT_EQ(a.features, b.features);
  EXPECT_TRUE(a.decoder == b.decoder);
}

TEST(Fit, RejectsMismatchedSizes) {
  FitProblem p = problem(false);
  p.colors.pop_back();
  EXPECT_THROW(fit(p, {}), std::invalid_argument);
}

}  // namespace
}  // namespace rebake::test
