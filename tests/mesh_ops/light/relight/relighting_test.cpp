// Gains and offsets of relighting: the identity if light does not change, and bounded colours if the albedo is unknown.
#include "mesh_ops/light/relight/relighting.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>

namespace rebake::test {
namespace {

// Sites in a row, one texel each, all of one part.
struct Row {
  explicit Row(std::size_t count) : colors(count), before(count) {
    auto chart = std::make_shared<LightChart>();
    chart->width = static_cast<int>(count);
    chart->height = 1;
    for (std::size_t i = 0; i < count; ++i) chart->nodes.push_back({static_cast<std::uint32_t>(i), 0, {1, 0, 0}, 0});
    charts.push_back(chart);
    sites.first = {0, count};
    sites.body.assign(count, 0);
    sites.part.assign(count, 0);
    sites.baked.assign(count, LightSite{});
    for (LightSite& site : sites.baked) site.normal = Vec3::UnitY();
    sites.now = sites.baked;
  }
  // Colour of a site in the new light.
  Radiance lit(const std::vector<Radiance>& after, std::size_t site) const {
    const auto maps = light_maps(charts, sites, colors, before, after, sites.now);
    if (!maps.front()) return colors[site];
    const LightMap& map = *maps.front();
    Radiance result = map.gain[site].cast<double>().cwiseProduct(colors[site]);
    if (!map.offset.empty()) result += map.offset[site].cast<double>();
    return result.cwiseMax(0);
  }
  std::vector<std::shared_ptr<const LightChart>> charts;
  LightSites sites;
  std::vector<Radiance> colors, before;
};

TEST(Relighting, OccludedSurfacesDoNotGlow) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(0, 1);
  for (int round = 0; round < 50; ++round) {
    // Lit sites have albedos of at most 0.4; every tenth site is occluded and has a random colour.
    Row row(200);
    std::vector<Radiance> after;
    for (std::size_t i = 0; i < 200; ++i) {
      const bool hidden = i % 10 == 0;
      row.before[i] = Radiance::Constant(hidden ? 0.02 * any(random) : 0.7 + 0.3 * any(random));
      row.colors[i] = hidden ? Radiance(any(random), any(random), any(random))
                             : Radiance((0.2 + 0.2 * any(random)) * row.before[i]);
      after.emplace_back(Radiance::Constant(0.8));
    }
    for (std::size_t i = 0; i < 200; i += 10) {
      const Radiance shown = row.lit(after, i);
      // At most albedo 0.4 in light 0.8, plus a little of the baked colour.
      EXPECT_LE(shown.maxCoeff(), 0.4 * 0.8 + 0.08) << row.colors[i].transpose() << ", before " << row.before[i][0];
    }
    EXPECT_EQ(row.lit(row.before, 0), row.colors[0]) << "unchanged light changes nothing";
  }
}

TEST(Relighting, LitSurfacesScaleWithLight) {
  Row row(100);
  std::vector<Radiance> after(100, Radiance::Constant(1));
  for (std::size_t i = 0; i < 100; ++i) {
    row.before[i] = Radiance::Constant(i < 50 ? 0.5 : 1);
    row.colors[i] = 0.3 * row.before[i];
  }
  EXPECT_NEAR(row.lit(after, 0)[0], 0.3, 0.01);
  EXPECT_NEAR(row.lit(after, 99)[0], 0.3, 1e-6);
}

}  // namespace
}  // namespace rebake::test
