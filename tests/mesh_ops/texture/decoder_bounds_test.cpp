// Bounds on the influence of view direction and features on decoded colours: valid for random inputs, and not too wide.
#include "mesh_ops/texture/decoder_bounds.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

class DecoderBounds : public ::testing::Test {
 protected:
  double any(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Vec3 direction() {
    std::normal_distribution<double> normal;
    return any(0, 1) * Vec3(normal(random_), normal(random_), normal(random_)).normalized();
  }
  std::mt19937_64 random_{5};
};

TEST_F(DecoderBounds, NoDirectionChangesMoreThanTheBound) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Decoder decoder = made_decoder(seed, 4 + static_cast<int>(seed) % 13);
    decoder.weights0.bottomRows(3) *= std::pow(10.0, -any(0, 6));
    const DirectionInfluence use = direction_influence(decoder);
    double largest = 0;
    for (int k = 0; k < 200; ++k) {
      std::array<double, 8> features;
      for (double& f : features) f = any(-1, 1);
      const Color with = decode(decoder, features, direction()),
                  without = decode(*use.without, features, Vec3(0, 0, 0));
      largest = std::max(largest, (with - without).cwiseAbs().maxCoeff());
    }
    EXPECT_LE(largest, use.change) << seed;
    EXPECT_GT(largest, use.change / 1000) << seed << ": the bound is too wide";
  }
  Decoder blind = made_decoder(1);
  blind.weights0.bottomRows(3).setZero();
  EXPECT_EQ(direction_influence(blind).change, 0);
}

TEST_F(DecoderBounds, ColorsLieInRange) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const Decoder decoder = made_decoder(seed, 4 + static_cast<int>(seed) % 13);
    FeatureRange range{true, {}, {}};
    for (std::size_t k = 0; k < 8; ++k) {
      range.low[k] = any(-1, 1);
      range.high[k] = range.low[k] + any(0, 0.1);
    }
    const double share = any(0.05, 1);
    const ColorRange colors = color_range(decoder, range, share);
    for (int k = 0; k < 200; ++k) {
      std::array<double, 8> features;
      for (std::size_t f = 0; f < 8; ++f) features[f] = share * any(range.low[f], range.high[f]);
      const Color color = decode(decoder, features, share * direction());
      for (int c = 0; c < 3; ++c) {
        EXPECT_GE(color[c], colors.low[c]) << seed;
        EXPECT_LE(color[c], colors.high[c]) << seed;
      }
    }
  }
}

TEST_F(DecoderBounds, NarrowRangeOnlyForOneColour) {
  EXPECT_FALSE(narrow_feature_range(*made_object()->sets[0].texels));
  const auto texture = [](Texel opaque) {
    return FeatureTexture::from_rows(300, 40, AlphaCode::halved, [opaque](int y, Texel* row) {
      std::fill_n(row, 300, y % 2 == 0 ? opaque : empty_texel(AlphaCode::halved));
    });
  };
  const Texel grey{{100, 150, 200, 200}, {1, 2, 3, 250}};
  const auto range = narrow_feature_range(texture(grey));
  ASSERT_TRUE(range && range->any);
  EXPECT_EQ(range->low, decode_features(grey, AlphaCode::halved));
  EXPECT_EQ(range->high, range->low);
  EXPECT_FALSE(narrow_feature_range(texture({}))->any) << "nothing is opaque";
}

}  // namespace
}  // namespace rebake::test
