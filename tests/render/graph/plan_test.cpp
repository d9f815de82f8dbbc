// Frame plans, without a GPU: which effects run, and why. Effects that a scene does not call for must not run.
#include "render/graph/effects.h"

#include <gtest/gtest.h>

#include <set>

#include "mesh_ops/base/error.h"
#include "render/gpu_scene/resources.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

TEST(Plan, OneSampleNeedsNoSupersampling) {
  View view;
  view.samples = 1;
  EXPECT_FALSE(plan(scene_of(made_object()), view).runs(effects::supersampling));
  view.samples = 4;
  EXPECT_TRUE(plan(scene_of(made_object()), view).runs(effects::supersampling));
}

TEST(Plan, CompositingOnlyForSeveralDecoders) {
  Scene scene = scene_of(made_object({.seed = 1}));
  EXPECT_FALSE(plan(scene, {}).runs(effects::decoder_compositing));
  Node other;
  other.object = made_object({.seed = 1});  // equal weights at another address count as the same decoder
  scene = with_added(scene, other, NodeId::none, 9);
  EXPECT_FALSE(plan(scene, {}).runs(effects::decoder_compositing));
  EXPECT_FALSE(plan(scene, {}).runs(effects::node_frames));
  other.object = made_object({.seed = 2});
  scene = with_added(scene, other, NodeId::none, 9);
  EXPECT_TRUE(plan(scene, {}).runs(effects::decoder_compositing));
}

TEST(Plan, NamesTheSizesOfAllDecoders) {
  const auto words = [](std::initializer_list<Decoder> decoders) {
    Scene scene;
    for (const Decoder& decoder : decoders) {
      auto object = std::make_shared<BakedObject>(*made_object());
      object->decoder = std::make_shared<const Decoder>(decoder);
      Node node;
      node.object = object;
      scene = with_added(scene, node, NodeId::none, 99);
    }
    return describe_decoder(plan(scene, {}));
  };
  const Decoder large = made_decoder(1), other = made_decoder(2), small = made_decoder(3, 8, 4);
  Decoder diffuse = made_decoder(4);
  diffuse.rule = ColorRule::diffuse;
  EXPECT_EQ(words({large, other}), "decoder 11-16-16-3, weights as constants");
  EXPECT_EQ(words({large, small}), "decoders 11-16-16-3 and 11-8-4-3, weights as constants");
  EXPECT_EQ(words({diffuse, small}), "decoder 11-8-4-3, weights as constants");
  EXPECT_EQ(words({diffuse}), "colours are read from the textures");
}

TEST(Plan, CulledAndHiddenObjectsCostNoDraw) {
  Scene scene = scene_of(made_object());
  const NodeId id = scene.roots[0]->id;
  EXPECT_EQ(plan(scene, {}).draws.size(), 1U);
  EXPECT_TRUE(plan(with_changed(scene, id, [](Node& n) { n.visible = false; }), {}).draws.empty());
  for (const Vec3& away : {Vec3(50, 0, 0), Vec3(0, 50, 0), Vec3(0, 30, 50), Vec3(0, -900, -1600)}) {
    const FramePlan frame = plan(with_changed(scene, id, [&](Node& n) { n.to_parent.translation() = away; }), {});
    EXPECT_TRUE(frame.draws.empty()) << away.transpose();
    EXPECT_TRUE(frame.runs(effects::culling));
    EXPECT_FALSE(frame.runs(effects::geometry));
  }
}

TEST(Plan, EveryPassHasAReason) {
  for (const PlannedPass& pass : plan(scene_of(made_object()), {}).passes) EXPECT_FALSE(pass.why.empty()) << pass.name;
}

TEST(Plan, ShadingIsChosenBySamplesAndWeights) {
  const Scene scene = scene_of(made_object());
  View view;
  view.samples = 1;
  EXPECT_TRUE(plan(scene, view).runs(effects::forward));
  EXPECT_TRUE(plan(scene, view, {RenderOptions::Weights::buffer, {}, {}}).runs(effects::resolve));
  view.samples = 4;
  EXPECT_TRUE(plan(scene, view).runs(effects::resolve));
}

TEST(Plan, WidePixelsGetARayPerSample) {
  View view;
  view.height = 200;
  view.camera.fov_degrees = 40;
  EXPECT_FALSE(plan(scene_of(made_object()), view).runs(effects::ray_per_sample));
  view.camera.fov_degrees = 60;
  EXPECT_TRUE(plan(scene_of(made_object()), view).runs(effects::ray_per_sample));
}

TEST(Plan, RejectsForwardShadingWithSupersampling) {
  EXPECT_THROW(plan(scene_of(made_object()), {}, {{}, RenderOptions::Shading::forward, {}}), FieldError);
}

Scene with_node(const Scene& scene, const std::shared_ptr<const BakedObject>& object, bool visible) {
  Node node;
  node.object = object;
  node.visible = visible;
  return with_added(scene, std::move(node), NodeId::none, scene.roots.size());
}

// Texels are coded only if they take much memory. Hidden nodes are on the GPU too, and a shared texture counts once.
TEST(Plan, CodesTexelsOfLargeScenes) {
  using Texels = RenderOptions::Texels;
  constexpr int side = 4096;  // 128 MiB
  const auto large = [] {
    auto object = std::make_shared<BakedObject>(*made_object());
    object->sets[0].texels = std::make_shared<const FeatureTexture>(FeatureTexture::from_parts(
        side, side, AlphaCode::halved,
        [](int, int count, Texel* texels) { std::fill_n(texels, static_cast<std::size_t>(count) * side, Texel{}); }));
    return object;
  };
  const auto one = large(), two = large();
  Scene scene;
  for (const auto& object : {one, two, one, two}) scene = with_node(scene, object, object == one);
  EXPECT_FALSE(plan(scene, {}).runs(effects::coded_texels)) << "256 MiB";
  scene = with_node(scene, made_object(), true);
  EXPECT_TRUE(plan(scene, {}).runs(effects::coded_texels));
  EXPECT_TRUE(uses_coded_texels(scene, Texels::automatic));
  RenderOptions options;
  options.texels = Texels::plain;
  EXPECT_FALSE(plan(scene, {}, options).runs(effects::coded_texels));
  DeviceFacts device;
  device.reads_coded_texels = false;
  EXPECT_FALSE(uses_coded_texels(scene, Texels::coded, device)) << "the driver does not support it";
}

TEST(Plan, RejectsFlattenedNodeByName) {
  Scene scene = scene_of(made_object(), "leaf");
  scene = with_changed(scene, scene.roots[0]->id, [](Node& n) { n.to_parent.linear()(1, 1) = 0; });
  try {
    plan(scene, {});
    FAIL();
  } catch (const EditError& error) {
    EXPECT_NE(std::string(error.what()).find("leaf"), std::string::npos);
  }
}

TEST(Resources, UnchangedPartsAreNotUploadedTwice) {
  const Scene before = scene_of(made_object());
  const TextureSet& set = before.roots[0]->object->sets[0];
  const auto first = diff({}, {}, before, false);
  EXPECT_EQ(first.meshes.size() + first.surfaces.size(), 2U);
  const std::set<MeshKey> meshes{mesh_key(set, false)};
  const std::set<SurfaceKey> surfaces{surface_key(set, false)};
  const Scene moved = with_changed(before, before.roots[0]->id, [](Node& n) { n.to_parent.translation().x() = 3; });
  const auto again = diff(meshes, surfaces, moved, false);
  EXPECT_TRUE(again.meshes.empty() && again.surfaces.empty() && again.released_meshes.empty());
  const auto gone = diff(meshes, surfaces, {}, false);
  EXPECT_EQ(gone.released_meshes.size() + gone.released_surfaces.size(), 2U);
}

// An effect reads only targets that it or an earlier effect writes; names are unique.
TEST(Effects, ReadOnlyWrittenTargets) {
  std::set<Target> written;
  std::set<std::string> names;
  for (const Effect* effect : effect_table()) {
    EXPECT_TRUE(names.insert(effect->name).second) << effect->name;
    if (effect->execute == nullptr) {
      EXPECT_TRUE(effect->reads.empty() && effect->writes.empty()) << effect->name;
    }
    std::set<Target> own;
    for (const Use& use : effect->writes) own.insert(use.target);
    for (const Use& use : effect->reads)
      EXPECT_TRUE(written.contains(use.target) || own.contains(use.target)) << effect->name;
    written.merge(own);
  }
}

}  // namespace
}  // namespace rebake::test
