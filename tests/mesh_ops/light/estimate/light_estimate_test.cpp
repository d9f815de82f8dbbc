// Estimation of baked light from colours.
#include "mesh_ops/light/estimate/light_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mesh_ops/index/index.h"
#include "mesh_ops/light/relight/relighting.h"
#include "mesh_ops/light/transport/irradiance.h"
#include "mesh_ops/light/transport/light_sites.h"
#include "tests/support/lit_objects.h"

namespace rebake::test {
namespace {

// A box on a ground under a known sun and sky: the sun's direction and strength are estimated from colours alone.
TEST(LightEstimate, FindsTheSunFromShadows) {
  const Vec3 towards = Vec3(0.5, 0.8, 0.35).normalized();
  Light truth;
  truth.sky = SkyMap(Radiance::Constant(0.4));
  truth.suns = {{towards, 0.06, Radiance::Constant(0.9)}};
  std::vector<LitQuad> quads = box_quads({-0.4, 0, -0.4}, {0.4, 1, 0.4}, 4);
  quads.push_back(flat_quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, 12, 12));
  const auto shape = lit_object(quads, [](const Vec3&) { return Radiance(Radiance::Constant(0.5)); });
  const SceneRays rays({{rays_of(*shape), Affine::Identity(), shape->bounds().diagonal().norm()}});
  const std::vector<std::shared_ptr<const LightChart>> charts{
      std::make_shared<const LightChart>(light_chart(shape->sets.front(), 4))};
  const LightSites sites = light_sites(*shape, charts);
  const auto lit = traced_light(sites.baked, {}, rays, truth, Mat3::Identity(), {.rays = 1024});
  std::vector<Radiance> colors;
  // The ground is unoccluded on both sides and shows the mean of both.
  for (const SiteLight& one : lit) {
    const double first = facing_by_visibility(static_cast<double>(one.open[0]), static_cast<double>(one.open[1]));
    colors.push_back(0.5 * visible_irradiance(one, static_cast<float>(first)));
  }
  const LightEstimate found = estimated_light(sites, colors, rays, {.sites = 1500, .rays = 128});
  ASSERT_TRUE(found.sun);
  EXPECT_GT(found.light.suns.front().direction.dot(towards), std::cos(4 * std::numbers::pi / 180));
  const double ratio = found.light.suns.front().irradiance[0] / found.light.sky.mean()[0];
  EXPECT_GT(ratio, 0.8 * 0.9 / 0.4);
  EXPECT_LT(ratio, 1.3 * 0.9 / 0.4);
  EXPECT_GT(found.confidence, 0.9);
}

TEST(LightEstimate, EmptyInputIsDark) {
  const LightEstimate none = estimated_light({}, {}, SceneRays({}));
  EXPECT_TRUE(none.light.sky.black());
  EXPECT_EQ(none.confidence, 0);
}

}  // namespace
}  // namespace rebake::test
