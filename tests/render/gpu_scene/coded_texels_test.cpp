// Coded texels (block compression on the GPU) are lossless and take about half the memory for trained features.
#include "render/gpu_scene/coded_texels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "render/gpu_scene/surface.h"
#include "render/picture.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

constexpr int texture_size = 600;  // three tiles per side, the last ones partial

// Random rectangles that do not overlap; some cross tiles.
std::vector<PackedRect> many_rects() {
  std::vector<PackedRect> rects;
  std::mt19937 random(3);
  for (int top = 0; top < texture_size;) {
    const int height = std::min<int>(1 + static_cast<int>(random() % 40), texture_size - top);
    for (int left = 0; left < texture_size;) {
      const int width = std::min<int>(1 + static_cast<int>(random() % 40), texture_size - left);
      rects.push_back({static_cast<std::uint16_t>(left), static_cast<std::uint16_t>(top),
                       static_cast<std::uint16_t>(width), static_cast<std::uint16_t>(height)});
      left += width;
    }
    top += height;
  }
  return rects;
}

struct Kind {
  const char* name;
  std::uint8_t least, most;  ///< smallest and largest value of a channel
  double opaque;
};

class CodedTexelKinds : public ::testing::TestWithParam<Kind> {};

// Covers all bit widths: from 0 for equal values, over 7, which is stored as 8, to 8.
TEST_P(CodedTexelKinds, RoundTrip) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<Texel> texels(static_cast<std::size_t>(texture_size) * texture_size);
  for (Texel& texel : texels) {
    for (auto* feat : {&texel.feat0, &texel.feat1})
      for (std::uint8_t& channel : *feat)
        channel = static_cast<std::uint8_t>(GetParam().least + random() % (GetParam().most - GetParam().least + 1U));
    if (share(random) >= GetParam().opaque) texel.feat0[0] = 0;
  }
  const FeatureTexture texture =
      FeatureTexture::from_rows(texture_size, texture_size, AlphaCode::plain, [&](int y, Texel* row) {
        std::copy_n(texels.begin() + static_cast<std::ptrdiff_t>(y) * texture_size, texture_size, row);
      });
  const std::vector<PackedRect> rects = many_rects();
  const CodedTexels made = coded(rects, texture);
  ASSERT_EQ(made.first_block.size(), rects.size() + 1);
  for (std::size_t k = 0; k < rects.size(); ++k)
    for (int y = 0; y < rects[k].height; ++y)
      for (int x = 0; x < rects[k].width; ++x) {
        const Texel& texel = texels[static_cast<std::size_t>(rects[k].y + y) * texture_size + rects[k].x + x];
        ASSERT_EQ(decoded(made, rects[k], k, x, y), texel.opaque() ? texel : Texel{}) << k << ": " << x << ", " << y;
      }
}
INSTANTIATE_TEST_SUITE_P(Kinds, CodedTexelKinds,
                         ::testing::Values(Kind{"Noise", 1, 255, 1}, Kind{"NoiseWithHoles", 1, 255, 0.4},
                                           Kind{"Alike", 77, 77, 1}, Kind{"AlikeWithHoles", 200, 200, 0.5},
                                           Kind{"OneBit", 254, 255, 0.9}, Kind{"SixBits", 100, 163, 0.8},
                                           Kind{"SevenBits", 100, 227, 0.8}, Kind{"Nothing", 1, 255, 0}),
                         [](const auto& kind) { return kind.param.name; });

TEST(CodedTexels, HalvesMemoryOfRealFeatures) {
  for (const char* name : {"lego_ball", "lego_tractor"}) {
    const auto object = morpheus_object(name);
    if (!object) GTEST_SKIP() << "REBAKE_TEST_DATA has no such scene";
    const PreparedSurface surface = prepared_surface(object->sets[0], true);
    ASSERT_TRUE(surface.coded);
    const double bytes = static_cast<double>(surface.coded->blocks.size() * sizeof(TexelBlock) +
                                             surface.coded->words.size() * sizeof(std::uint64_t));
    EXPECT_LT(bytes, 0.64 * 8 * 1020 * 1020) << name;
    View view;
    view.width = view.height = 200;
    RenderOptions options;
    options.texels = RenderOptions::Texels::coded;
    EXPECT_EQ(Renderer().render(scene_of(object), view, options).rgb, Renderer().render(scene_of(object), view).rgb);
  }
}

// All draw modes read coded texels: shading, inspection, selection and outlines.
TEST(CodedTexels, PictureIsUnchanged) {
  const auto object = made_object({.columns = 32, .rows = 16});
  Node other;
  other.object = made_object({.seed = 2});
  Scene scene = with_added(scene_of(object), other, NodeId::none, 1);
  View view;
  view.width = view.height = 160;
  const auto expect_same = [&](const View& from, RenderOptions options, const Guides& guides, const char* what) {
    std::vector<Image> images;
    for (const auto texels : {RenderOptions::Texels::plain, RenderOptions::Texels::coded}) {
      options.texels = texels;
      Renderer renderer;
      renderer.show(scene, from, options, guides, false);
      images.push_back(renderer.shown_image());
    }
    EXPECT_EQ(images[0].rgb, images[1].rgb) << what;
  };
  expect_same(view, {}, {}, "four samples");
  view.samples = 1;
  RenderOptions deferred;
  deferred.shading = RenderOptions::Shading::deferred;
  expect_same(view, deferred, {}, "deferred");
  expect_same(view, {}, {}, "forward");
  Guides guides;
  guides.channel = 5;
  for (const auto look : {Guides::Inspect::opacity, Guides::Inspect::channel, Guides::Inspect::overdraw}) {
    guides.inspect = look;
    expect_same(view, {}, guides, "inspected");
  }
  scene = with_changed(scene, scene.roots[0]->id, [&](Node& node) {
    auto flags = std::make_shared<TriangleSet>(object->triangle_count(), 0);
    std::fill_n(flags->begin(), 300, std::uint8_t{1});
    node.selection = flags;
  });
  guides = {};
  guides.outlined = {scene.roots[1]->id};
  expect_same(view, {}, guides, "selected and outlined");
}

}  // namespace
}  // namespace rebake::test
