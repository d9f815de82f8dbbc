#include "mesh_ops/light/learned/dprt_network.h"

#include <gtest/gtest.h>

#include <random>

#include "mesh_ops/base/error.h"

namespace rebake {
namespace {

constexpr int side = 32, channels = 8;

DprtNetwork random_network() {
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  std::vector<float> weights(unet_weight_count(UnetForm::concatenated, channels));
  for (float& w : weights) w = 0.05F * normal(random);
  DprtNetwork::Ranges ranges;
  ranges.center = {1, 2, 3};
  ranges.reach = 0.5;
  for (std::size_t c = 0; c < sh::count; ++c) {
    ranges.low[c] = -0.1F * static_cast<float>(c);
    ranges.high[c] = 1;
  }
  return {Unet(UnetForm::concatenated, side, channels, weights), ranges};
}

std::vector<LightSite> wavy_sites() {
  std::vector<LightSite> sites;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      sites.push_back({{1 + 0.01 * x, 2 + 0.01 * y, 3 + 0.05 * std::sin(0.3 * x)}, {0, 0, 1}, {1, 0, 0}, {0, 0}});
  return sites;
}

TEST(DprtNetwork, FilesHoldWhatPredicts) {
  const DprtNetwork network = random_network();
  const std::string bytes = network.bytes();
  const DprtNetwork read = DprtNetwork::parsed(bytes);
  EXPECT_EQ(network.predict(wavy_sites()), read.predict(wavy_sites()));
  EXPECT_LT(bytes.size(), (network.net().weights().size() + 40) * sizeof(float) + 200) << "nothing else is stored";
}

TEST(DprtNetwork, PredictsWithinItsRanges) {
  const DprtNetwork network = random_network();
  const std::vector<float> found = network.predict(wavy_sites());
  const std::size_t texels = side * side;
  ASSERT_EQ(found.size(), sh::count * texels);
  for (std::size_t c = 0; c < sh::count; ++c)
    for (std::size_t t = 0; t < texels; ++t) {
      EXPECT_GE(found[c * texels + t], network.ranges().low[c]);
      EXPECT_LE(found[c * texels + t], network.ranges().high[c]);
    }
}

TEST(DprtNetwork, RefusesDamagedFiles) {
  const std::string bytes = random_network().bytes();
  EXPECT_THROW(DprtNetwork::parsed(""), Error);
  EXPECT_THROW(DprtNetwork::parsed("{}\n"), Error);
  EXPECT_THROW(DprtNetwork::parsed(bytes.substr(0, bytes.size() - 1)), Error);
  for (const std::size_t at : {bytes.find('\n') + 9, bytes.size() / 2, bytes.size() - 1}) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    EXPECT_THROW(DprtNetwork::parsed(damaged), Error) << at;
  }
  std::string lying = bytes;
  lying.replace(lying.find("\"channels\":8"), 12, "\"channels\":9");
  EXPECT_THROW(DprtNetwork::parsed(lying), Error);
}

TEST(DprtNetwork, RefusesSitesAndRangesThatDoNotFit) {
  EXPECT_THROW(random_network().predict({}), std::invalid_argument);
  DprtNetwork::Ranges empty;
  empty.reach = 0;
  EXPECT_THROW(DprtNetwork(random_network().net(), empty), std::invalid_argument);
}

}  // namespace
}  // namespace rebake
