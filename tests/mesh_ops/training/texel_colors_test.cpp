// TexelColors: decoding in batches equals decoding one texel at a time.
#include "mesh_ops/training/texel_colors.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace rebake::test {
namespace {

Decoder random_decoder(std::size_t hidden, std::uint64_t seed) {
  FeatureNetwork network(decoder_inputs, hidden, hidden, 3);
  randomise(network, seed);
  return network.to_decoder();
}

TEST(TexelColors, BatchMatchesSingleTexels) {
  SplitMix64 dice(3);
  const std::vector<Vec3> some = even_directions(7);
  for (const std::size_t hidden : {4, 16, 300})
    for (const std::size_t count : {0, 1, 15, 16, 17, 72}) {
      const Decoder decoder = random_decoder(hidden, count);
      const TexelColors look(decoder, some);
      std::vector<TexelColors::Features> features(count);
      std::vector<Vec3> directions(count);
      for (std::size_t k = 0; k < count; ++k) {
        for (double& f : features[k]) f = dice.share();
        directions[k] = Vec3(dice.share() - 0.5, dice.share() - 0.5, dice.share() - 0.5).normalized();
      }
      std::vector<Color> each(count), all(count * some.size());
      look.decode_each(features, directions, each);
      look.decode_into(features, all);
      double worst = 0;
      for (std::size_t k = 0; k < count; ++k) {
        worst = std::max(worst, (each[k] - decode(decoder, features[k], directions[k])).cwiseAbs().maxCoeff());
        for (std::size_t d = 0; d < some.size(); ++d)
          worst =
              std::max(worst, (all[k * some.size() + d] - decode(decoder, features[k], some[d])).cwiseAbs().maxCoeff());
      }
      EXPECT_LE(worst, hidden > widest_layer ? 0 : 1e-5) << hidden << " neurons, " << count << " texels";
    }
}

}  // namespace
}  // namespace rebake::test
