#include "mesh_ops/reconstruction/pixel_mean.h"

#include <gtest/gtest.h>

#include <random>

using namespace rebake;

namespace {

// Two pixels of four rays with few hits, some of which have no features.
struct Pixels {
  RayBatch batch;
  WeightedHits kind;
  ShownHits shown;

  Pixels() {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(0, 1);
    batch.first.push_back(0);
    for (std::size_t r = 0; r < 8; ++r) {
      batch.rays.push_back({Vec3::Zero(), Vec3::UnitX(), {1, 0, 0}});
      batch.hits.resize(batch.hits.size() + r % 4);
      batch.first.push_back(batch.hits.size());
    }
    for (std::size_t h = 0; h < batch.hits.size(); ++h) {
      kind.opacities.push_back(double{unit(random)});
      shown.index.push_back(h % 5 == 4 ? -1 : static_cast<std::int32_t>(shown.hits.size()));
      if (h % 5 == 4) continue;
      shown.hits.push_back(static_cast<std::uint32_t>(h));
      for (std::size_t f = 0; f < texel_features; ++f) shown.features.push_back(unit(random));
    }
    weigh();
  }
  void weigh() {
    kind.weights.resize(8);
    for (std::size_t r = 0; r < 8; ++r)
      set_weights({kind.opacities.data() + batch.first[r], batch.first[r + 1] - batch.first[r]}, kind.weights[r]);
  }
  // A loss that is linear in the means.
  double loss() {
    weigh();
    double sum = 0;
    for (std::size_t p = 0; p < 2; ++p) {
      const PixelMean mean = mean_of(batch, p, 4, kind, shown);
      for (std::size_t f = 0; f < texel_features; ++f) sum += (0.3 * static_cast<double>(f) - 1) * mean.features[f];
      sum += 0.7 * mean.opacity;
    }
    return sum;
  }
};

}  // namespace

TEST(PixelMean, SlopesMatchDifferences) {
  Pixels pixels;
  std::vector<float> feature_slopes(pixels.shown.features.size()), alpha_slopes(pixels.batch.hits.size());
  for (std::size_t p = 0; p < 2; ++p) {
    PixelMean mean = mean_of(pixels.batch, p, 4, pixels.kind, pixels.shown);
    for (std::size_t f = 0; f < texel_features; ++f) mean.feature_slopes[f] = 0.3 * static_cast<double>(f) - 1;
    mean.opacity_slope = 0.7;
    add_hit_slopes(pixels.batch, p, 4, pixels.kind, pixels.shown, mean, feature_slopes, &alpha_slopes);
  }
  constexpr double step = 1e-6;
  for (std::size_t h = 0; h < alpha_slopes.size(); ++h) {
    const double here = pixels.kind.opacities[h];
    pixels.kind.opacities[h] = here + step;
    const double above = pixels.loss();
    pixels.kind.opacities[h] = here - step;
    EXPECT_NEAR(double{alpha_slopes[h]}, (above - pixels.loss()) / (2 * step), 1e-6);
    pixels.kind.opacities[h] = here;
  }
  constexpr float coarse = 0.125F;  // the loss is linear in the features
  for (std::size_t k = 0; k < feature_slopes.size(); ++k) {
    const float here = pixels.shown.features[k];
    pixels.shown.features[k] = here + coarse;
    const double above = pixels.loss();
    pixels.shown.features[k] = here - coarse;
    EXPECT_NEAR(double{feature_slopes[k]}, (above - pixels.loss()) / (2 * double{coarse}), 1e-5);
    pixels.shown.features[k] = here;
  }
}

TEST(PixelMean, OpaqueSurfaceHidesWhatLiesBehind) {
  Pixels pixels;
  for (double& opacity : pixels.kind.opacities) opacity = 1;
  const double before = pixels.loss();
  for (std::size_t r = 0; r < 8; ++r)
    for (std::size_t h = pixels.batch.first[r] + 1; h < pixels.batch.first[r + 1]; ++h) pixels.kind.opacities[h] = 0.3;
  EXPECT_EQ(pixels.loss(), before);
}
