// Plain colours as MobileNeRF features.
#include "mesh_ops/features/distill/diffuse_network.h"

#include <gtest/gtest.h>

#include "mesh_ops/features/distill/composition.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/texture/texel_rows.h"
#include "render/compare.h"
#include "render/picture.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

// All 256 values of each channel, the channels in different orders.
BakedObject all_colors() {
  BakedObject object;
  object.decoder = std::make_shared<const Decoder>(diffuse_decoder());
  object.axes = Axes::forward;
  object.dialect.alpha = AlphaCode::plain;
  const auto texels = FeatureTexture::from_rows(16, 16, AlphaCode::plain, [](int y, Texel* row) {
    for (int x = 0; x < 16; ++x) {
      const auto v = static_cast<std::uint8_t>(16 * y + x);
      row[x] = {{255, v, static_cast<std::uint8_t>(255 - v), static_cast<std::uint8_t>(v * 7)}, {0, 0, 0, 255}};
    }
  });
  object.sets.push_back({Soup({Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 0)},
                              {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}, {Face{0, 1, 2}, Face{0, 2, 3}}),
                         std::make_shared<const FeatureTexture>(texels)});
  return object;
}

TEST(DiffuseNetwork, ColoursOfWholePixelsAreKept) {
  const BakedObject before = all_colors();
  const auto after = with_network(before);
  EXPECT_EQ(after->decoder->rule, ColorRule::network);
  const TexelReader a(*before.sets[0].texels), b(*after->sets[0].texels);
  // Split folders store features 3 and 7 with 7 bits.
  for (const AlphaCode code : {AlphaCode::plain, AlphaCode::halved})
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) {
        const Texel stored = converted_texel(b.at(x, y), AlphaCode::plain, code);
        const Color color = decode(*after->decoder, decode_features(stored, code), Vec3(1, 0, 0));
        for (int c = 0; c < 3; ++c) {
          const int value = a.at(x, y).feat0[static_cast<std::size_t>(c) + 1];
          EXPECT_NEAR(255 * color[c], std::clamp(value, 1, 254), 0.1) << value;
        }
      }
  // Outlines tend to grey.
  std::array<double, 8> half = decode_features(b.at(15, 15), AlphaCode::plain);
  for (double& feature : half) feature /= 2;
  EXPECT_NEAR(decode(*after->decoder, half, Vec3::Zero())[0], 0.94, 0.005);
}

// UVs on the border of the texture lie, once it is packed, in texels of the neighbouring patch.
TEST(DiffuseNetwork, PatchesThatTouchStaySeparateParts) {
  Scene scene = scene_of(made_object(), "ball");
  Node prop;
  prop.name = "prop";
  prop.object = std::make_shared<const BakedObject>(all_colors());
  scene = with_added(scene, prop, NodeId::none, 1);
  const Composition composition = composed(scene, 4096);
  std::vector<std::uint64_t> texels(composition.parts.size());
  for (const Composition::Block& block : composition.blocks) texels[block.part] += block.opaque;
  ASSERT_EQ(texels.size(), 2U);
  EXPECT_EQ(texels[1], 256U);
  EXPECT_EQ(texels[0], scene.roots[0]->object->opaque_texel_count());
}

TEST(DiffuseNetwork, ExportsAsMobileNerf) {
  const TemporaryFolder folder;
  const Scene scene = scene_of(std::make_shared<const BakedObject>(all_colors()), "prop");
  const ExportReport report = format_named("mobilenerf").write(scene, folder.path() / "out", {}, {});
  ASSERT_FALSE(report.notes.empty());
  EXPECT_NE(report.notes[0].find("stored as logits"), std::string::npos);
  const Scene back = read_any(folder.path() / "out", Axes::forward);
  View view;
  view.camera.eye = {0, 0, 3};
  view.width = view.height = 128;
  view.samples = 1;
  Renderer renderer;
  const Difference difference = compare(renderer.render(scene, view), renderer.render(back, view), 1);
  EXPECT_EQ(difference.share_beyond, 0);
}

}  // namespace
}  // namespace rebake::test
