// BakedLight is created once per set of source files and shared by all unedited objects that were read from them.
#include "mesh_ops/light/relight/baked_light.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/light/lighting.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

class BakedLightTest : public ::testing::Test {
 protected:
  BakedLightTest() {
    export_scene(scene_of(made_object({.columns = 8, .rows = 4})), folder_.path() / "ball", {});
    settings_.source = SceneLight::Source::uniform;
    settings_.zenith = Radiance(1, 1, 1);
  }
  std::shared_ptr<const BakedObject> read(Axes axes = Axes::y_up) const {
    return read_any(folder_.path() / "ball", axes).roots[0]->object;
  }

  TemporaryFolder folder_;
  SceneLight settings_;
  LightingOptions options_;
};

TEST_F(BakedLightTest, SharedByObjectsFromTheSameFiles) {
  BakedLights known(settings_, options_);
  const auto first = known.of(read(), {});
  EXPECT_EQ(known.of(read(), {}), first);
  EXPECT_NE(known.of(read(Axes::forward), {}), first);

  const auto whole = read();
  auto cut = std::make_shared<BakedObject>(*whole);
  record_bodies(*cut, *whole);
  TriangleSet half(cut->triangle_count(), 1);
  std::fill(half.begin() + half.size() / 2, half.end(), std::uint8_t{0});
  cut->sets[0].soup = subset(cut->sets[0].soup, half, 0, true);
  EXPECT_NE(known.of(cut, {}), first) << "an edited object has its own light data";

  export_scene(scene_of(made_object({.columns = 8, .rows = 4, .seed = 7})), folder_.path() / "other", {});
  std::filesystem::remove_all(folder_.path() / "ball");
  std::filesystem::rename(folder_.path() / "other", folder_.path() / "ball");
  EXPECT_NE(known.of(read(), {}), first) << "the folder's contents have changed";
}

TEST_F(BakedLightTest, LightsEveryNodeThatSharesIt) {
  Scene scene;
  for (const double x : {0.0, 2.5, 5.0}) {
    Node node;
    node.name = std::to_string(scene.roots.size());
    node.object = read();
    node.to_parent.translation().x() = x;
    scene = with_added(scene, std::move(node), NodeId::none, scene.roots.size());
  }
  scene.light = std::make_shared<const SceneLight>(settings_);
  const Lighting lighting = lighting_of(scene, {.rays = 16});
  for (const NodePtr& node : scene.roots)
    EXPECT_NE(lighting.map_of(node->id, 0, node->object->sets[0]), nullptr) << node->name;
}

// BakedLight::among() adds occluders to the cached self-shadowing: same light as tracing all occluders together.
TEST_F(BakedLightTest, AmongMatchesTracingAllOccluders) {
  BakedLights known(settings_, options_);
  const auto own = read();
  const auto light = known.of(own, {});
  ASSERT_TRUE(light->untouched());
  Affine beside = Affine::Identity();
  beside.translation() = Vec3(1.5, 0.5, 0);
  const Occluder other{own, beside};
  constexpr int rays = 40;
  const auto lit = light->among({other}, rays, {});
  const auto expected = cached_light(light->sites.now, light->sides, {{own, Affine::Identity()}, other}, *light->light,
                                     Mat3::Identity(), rays, nullptr, {});
  const auto alone = light->as_baked(light->sides, rays, {});
  int darker = 0;
  for (std::size_t i = 0; i < lit.size(); ++i)
    for (std::size_t side = 0; side < 2; ++side) {
      ASSERT_EQ(lit[i].irradiance[side], expected[i].irradiance[side]) << i;
      darker += lit[i].open[side] < alone[i].open[side] ? 1 : 0;
    }
  EXPECT_GT(darker, 10) << "the other object must occlude some sites";
}

}  // namespace
}  // namespace rebake::test
