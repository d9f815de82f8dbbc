// Light during a drag: transfer rotated with its surface, or predicted by a model trained on such poses.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "editor/actions/plain_scene.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/light/lighting.h"
#include "mesh_ops/light/train_transfer_model.h"
#include "tests/support/edits.h"
#include "tests/support/lit_objects.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/made_scenes.h"
#include "tests/support/thorough.h"

namespace rebake::test {
namespace {

using nlohmann::json;

TEST(LightEdit, FollowsDraggedTriangles) {
  const auto after = [](Scene made, const std::vector<json>& lines) {
    for (const json& line : lines) made = apply(made, read_edit(line, made)).scene;
    return made;
  };
  const Scene rest =
      after(table(), {{{"op", "light"}, {"source", "sky"}, {"sun_color", {0, 0, 0}}, {"rays", 1024}},
                      {{"op", "select"}, {"box", {{"min", {-0.4, 0.01, -0.4}}, {"max", {0.4, 1, 0.4}}}}}});
  const NodeId node = rest.roots.front()->id;
  const LightingOptions options{.turning = {node}};
  const Lighting start = lighting_of(rest, options);
  // Nothing moved: nothing changes.
  const auto same = dragged_lighting(rest, start, rest);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->maps, start.maps);
  EXPECT_EQ(same->decisions.size(), start.decisions.size());
  const auto turned_by = [&](const json& box, double degrees) {
    json line = {
        {"op", "bend"}, {"node", "table"}, {"degrees", degrees}, {"axis", {0, 1, 0}}, {"direction", {1, 0, 0}}};
    line["box"] = box;
    return after(rest, {line});
  };
  // Only the box is bent: its vertices are split from the rest, and the map belongs to the new ones.
  const Scene bent = turned_by({{"min", {-0.4, 0.01, -0.4}}, {"max", {0.4, 1, 0.4}}}, 60);
  const auto turned = dragged_lighting(rest, start, bent);
  ASSERT_TRUE(turned);
  EXPECT_NE(turned->map_of(node, 0, bent.roots.front()->object->sets.front()), nullptr);
  EXPECT_TRUE(runs(*turned, "self-shadow table"));
  // If everything rotates together, the result is that of tracing.
  const Scene tilted = after(rest, {{{"op", "select"}, {"box", {{"min", {-9, -9, -9}}, {"max", {9, 9, 9}}}}},
                                    {{"op", "transform"},
                                     {"node", "table"},
                                     {"selection", true},
                                     {"rotate", {{"axis", {1, 0, 0}}, {"degrees", 45}}}}});
  const Lighting truth = lighting_of(tilted, options);
  const auto &going = start.turning.at(node), &traced = truth.turning.at(node);
  const std::vector<Radiance> light = going->light_on(*tilted.roots.front()->object);
  double off = 0, all = 0;
  for (std::size_t i = 0; i < light.size(); ++i) {
    off += (light[i] - traced->start().after[i]).squaredNorm();
    all += (going->start().after[i] - traced->start().after[i]).squaredNorm();
  }
  EXPECT_GT(std::sqrt(all / static_cast<double>(light.size())), 0.1);
  EXPECT_LT(std::sqrt(off / all), 0.1) << "transfer with 64 rays has an error of 4 %";
  // If more than triangles changed, nothing is returned.
  EXPECT_FALSE(dragged_lighting(rest, start, after(rest, {{{"op", "delete"}}})));
  EXPECT_FALSE(
      dragged_lighting(rest, start, after(rest, {{{"op", "transform"}, {"node", "table"}, {"translate", {1, 0, 0}}}})));
  EXPECT_FALSE(dragged_lighting(rest, lighting_of(rest), bent)) << "drag light was not requested for this node";
}

// Options for a node that is about to be dragged, with the trained models in `store`.
LightingOptions going_along(NodeId node, ResultCache& store) {
  LightingOptions options;
  options.results = &store;
  options.turning = {node};
  return options;
}

TEST(LightEdit, UsesModelsWithinTheirRange) {
  // The box is lifted: nothing rotates, but the ground below is unoccluded again.
  Scene rest = with_light(table());
  const json box = {{"op", "select"}, {"box", {{"min", {-0.4, 0.01, -0.4}}, {"max", {0.4, 1, 0.4}}}}};
  rest = apply(rest, read_edit(box, rest)).scene;
  const NodeId node = rest.roots.front()->id;
  const auto lifted = [&](double by) {
    const json line = {{"op", "transform"}, {"node", "table"}, {"selection", true}, {"translate", {0, by, 0}}};
    return apply(rest, read_edit(line, rest)).scene;
  };
  CountingResults store;
  const LightingOptions options = going_along(node, store);
  const auto turning_now = [&](const Scene& scene) { return lighting_of(scene, options).turning.at(node); };
  const auto plain = turning_now(rest);
  const TransferModel model = trained_model(*plain, [&](int k) { return lifted(0.02 * k).roots.front()->object; },
                                            {.poses = 24, .rays = 64, .keys = 600});
  EXPECT_LT(model.error(), 0.8 * model.turning_error) << "the model must be better than rotation";
  const std::string bytes = bytes_of(model);
  store.keep(transfer_model_key(*rest.roots.front()->object, model.sites), bytes);
  const auto learned = turning_now(rest);
  const Scene moved = lifted(0.31);
  const std::vector<Radiance> truth = turning_now(moved)->start().after;
  const auto off = [&](const DragLight& turning) {
    const std::vector<Radiance> light = turning.light_on(*moved.roots.front()->object);
    double sum = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) sum += (light[i] - truth[i]).squaredNorm();
    return std::sqrt(sum);
  };
  EXPECT_LT(off(*learned), 0.45 * off(*plain));
  EXPECT_EQ(learned->light_on(*rest.roots.front()->object), learned->start().after) << "nothing jumps";
  const auto why = [&](const Scene& scene) {
    const auto lighting = dragged_lighting(rest, lighting_of(rest, options), scene);
    return lighting->decisions.back().why;
  };
  EXPECT_NE(why(moved).find("corrected by the trained model"), std::string::npos) << why(moved);
  const Scene far = lifted(5);
  EXPECT_NE(why(far).find("trained model not used: the pose is at"), std::string::npos) << why(far);
  EXPECT_EQ(learned->light_on(*far.roots.front()->object), plain->light_on(*far.roots.front()->object));

  // Models round-trip through bytes; damaged or foreign bytes are rejected.
  const TransferModel read = transfer_model_of(bytes);
  EXPECT_EQ(bytes_of(read), bytes);
  for (const std::size_t size : {std::size_t{0}, std::size_t{40}, bytes.size() / 2, bytes.size() - 1})
    EXPECT_THROW(transfer_model_of(std::string_view(bytes).substr(0, size)), Error);
  std::string damaged = bytes;
  damaged[bytes.size() / 2] ^= 1;
  EXPECT_THROW(transfer_model_of(damaged), Error);
  EXPECT_THROW(transfer_model_of("P6 1 1 255\n"), Error);
  // The model is not used for another object.
  const Scene other = with_light(scene_of(
      lit_object(box_quads({0, 0, 0}, {1, 1, 1}), [](const Vec3&) -> Radiance { return Radiance::Constant(0.4); }),
      "other"));
  LightingOptions of_other = options;
  of_other.turning = {other.roots.front()->id};
  EXPECT_EQ(lighting_of(other, of_other).turning.begin()->second->start().model, nullptr);
  // Models are not trained on an object that edits have moved.
  EXPECT_THROW(trained_model(*turning_now(moved), [&](int) { return moved.roots.front()->object; }, {.poses = 8}),
               Error);
}

// A network from training to use: trained on poses, stored as bytes, used in a drag. `published`: as published.
class NetworkOfPoses : public ::testing::TestWithParam<bool> {};
TEST_P(NetworkOfPoses, IsTrainedKeptAndUsed) {
  REBAKE_ONLY_DEEP();
  const bool published = GetParam();
  Scene rest = with_light(table());
  const NodeId node = rest.roots.front()->id;
  const auto bent = [&](double degrees) {
    const json line = {
        {"op", "bend"}, {"node", "table"}, {"degrees", degrees}, {"axis", {1, 0, 0}}, {"direction", {0, 1, 0}}};
    return apply(rest, read_edit(line, rest)).scene;
  };
  CountingResults store;
  const LightingOptions options = going_along(node, store);
  const auto turning_now = [&](const Scene& scene) { return lighting_of(scene, options).turning.at(node); };
  const auto plain = turning_now(rest);
  TransferModelOptions learning{.poses = 16, .rays = 64, .coarseness = 0.1};
  learning.net = UnetTraining{.channels = 8, .epochs = published ? 100 : 40, .batch = 4};
  learning.published = published;
  const auto pose = [&](int k) { return bent(4 * k - 30).roots.front()->object; };
  if (!can_train_unet()) {
    EXPECT_THROW(trained_model(*plain, pose, learning), Error);
    GTEST_SKIP() << "built without LibTorch";
  }
  const TransferModel model = trained_model(*plain, pose, learning);
  ASSERT_EQ(model.published.has_value(), published);
  ASSERT_EQ(model.net.has_value(), !published);
  EXPECT_EQ(model.learned.components.size(), 0) << "a network's file must hold only what predicts";
  // The published form also has to learn rotations, for which these poses are too few.
  EXPECT_LT(model.net_error, published ? 0.5 : model.turning_error);
  const std::string bytes = bytes_of(model);
  EXPECT_EQ(bytes_of(transfer_model_of(bytes)), bytes);
  for (std::size_t size = 0; size < bytes.size(); size += bytes.size() / 7)
    EXPECT_THROW(transfer_model_of(std::string_view(bytes).substr(0, size)), Error);
  store.keep(transfer_model_key(*rest.roots.front()->object, model.sites), bytes);
  const auto learned = turning_now(rest);
  ASSERT_TRUE(learned->start().model);
  EXPECT_EQ(learned->light_on(*rest.roots.front()->object), learned->start().after) << "nothing jumps";
  const Scene moved = bent(20), far = bent(170);
  EXPECT_NE(learned->light_on(*moved.roots.front()->object), plain->light_on(*moved.roots.front()->object));
  EXPECT_EQ(learned->light_on(*far.roots.front()->object), plain->light_on(*far.roots.front()->object))
      << "outside its range the model must not be used";
}
INSTANTIATE_TEST_SUITE_P(LightEdit, NetworkOfPoses, ::testing::Bool());

}  // namespace
}  // namespace rebake::test
