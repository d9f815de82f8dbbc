// Data that stays on the GPU between scenes: pictures must never show an earlier scene.
#include "render/gpu_scene/gpu_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <thread>
#include <tuple>

#include "render/gl/context.h"
#include "render/gpu_scene/surface.h"
#include "render/picture.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

View small_view() {
  View view;
  view.width = view.height = 150;
  view.camera.eye = {0.5, 1, 4};
  view.camera.near_plane = 0.1;
  return view;
}

// The first object with moved vertices, also rotated if `turns`, and all other data shared, as during a drag.
Scene bent(const Scene& scene, double amount, bool turns = false) {
  return with_changed(scene, scene.roots[0]->id, [&](Node& node) {
    auto object = std::make_shared<BakedObject>(*node.object);
    std::size_t first = 0;
    const TriangleSet all(object->triangle_count(), 1);
    for (TextureSet& set : object->sets) {
      const std::size_t count = set.soup.triangle_count();
      set.soup = change_vertices(set.soup, all, first, [&](std::uint32_t, Vec3& position, Mat3& turn) {
        position.x() += amount * position.y() * position.y();
        if (turns) turn = Eigen::AngleAxisd(amount * position.y(), Vec3::UnitZ()).toRotationMatrix();
      });
      first += count;
    }
    node.object = object;
  });
}

// With plain texels, and with coded ones; reference pictures use plain texels.
class GpuSceneTest : public ::testing::TestWithParam<bool> {
 protected:
  static RenderOptions options() {
    RenderOptions options;
    options.texels = GetParam() ? RenderOptions::Texels::coded : RenderOptions::Texels::plain;
    return options;
  }
};
INSTANTIATE_TEST_SUITE_P(Texels, GpuSceneTest, ::testing::Bool(),
                         [](const auto& coded) { return coded.param ? "Coded" : "Plain"; });

// As in the window, another thread prepares the uploads of the next picture meanwhile.
TEST_P(GpuSceneTest, PreparedScenesMatchAFreshRenderer) {
  const Scene scene = scene_of(made_object({.columns = 64, .rows = 40}));
  const View view = small_view();
  Renderer kept;
  kept.render(scene, view, options());
  for (const bool turns : {false, true})
    for (int k = 1; k <= 6; ++k) {
      const Scene next = bent(scene, 0.1 * k, turns);
      std::thread ahead([&] {
        kept.prepare(next);
        // Scenes that are never shown.
        for (int other = 0; other < 5; ++other) kept.prepare(bent(scene, 0.01 * other + k, turns));
      });
      kept.render(scene, view, options());
      ahead.join();
      Renderer fresh;
      EXPECT_EQ(kept.render(next, view, options()).rgb, fresh.render(next, view).rgb) << k;
    }
}

// New texels at the address of prepared ones that no longer exist must not be mistaken for them.
TEST_P(GpuSceneTest, PreparedDataOfDeletedTexelsIsNotReused) {
  const Scene scene = scene_of(made_object({.columns = 32, .rows = 16}));
  const auto with_texels = [&](bool empty) {
    return with_changed(scene, scene.roots[0]->id, [&](Node& node) {
      auto object = std::make_shared<BakedObject>(*node.object);
      const FeatureTexture& old = *object->sets[0].texels;
      object->sets[0].texels = std::make_shared<const FeatureTexture>(
          empty ? FeatureTexture::from_rows(
                      old.width(), old.height(), AlphaCode::halved,
                      [&](int, Texel* row) { std::fill_n(row, old.width(), empty_texel(AlphaCode::halved)); })
                : old);
      node.object = object;
    });
  };
  const View view = small_view();
  Renderer kept;
  kept.render({}, view, options());
  for (int k = 0; k < 8; ++k) {
    kept.prepare(with_texels(true));
    const Scene next = with_texels(false);
    kept.prepare(next);
    EXPECT_EQ(kept.render(next, view, options()).rgb, Renderer().render(next, view).rgb);
  }
}

TEST_P(GpuSceneTest, MovedVerticesMatchAFreshRenderer) {
  const Scene scene = scene_of(made_object({.columns = 64, .rows = 40}));
  const View view = small_view();
  Renderer kept;
  const Image first = kept.render(scene, view, options());
  EXPECT_EQ(bent(scene, 0.3).roots[0]->object->sets[0].soup.uvs(), scene.roots[0]->object->sets[0].soup.uvs());
  for (const double amount : {0.2, 0.5, -4.0}) {
    const Scene moved = bent(scene, amount);
    Renderer fresh;
    EXPECT_EQ(kept.render(moved, view, options()).rgb, fresh.render(moved, view).rgb) << amount;
  }
  // The same triangles with rotations; then again with other texels.
  Scene turned = bent(scene, 0.3, true);
  ASSERT_TRUE(turned.roots[0]->object->any_rotations());
  for (int k = 0; k < 2; ++k) {
    Renderer fresh;
    const Image drawn = kept.render(turned, view, options());
    EXPECT_EQ(drawn.rgb, fresh.render(turned, view).rgb);
    EXPECT_NE(drawn.rgb, kept.render(bent(scene, 0.3), view, options()).rgb) << "rotations must change the picture";
    turned = with_changed(turned, turned.roots[0]->id, [&](Node& node) {
      auto object = std::make_shared<BakedObject>(*node.object);
      object->sets[0].texels = made_object({.columns = 64, .rows = 40, .seed = 9})->sets[0].texels;
      node.object = object;
    });
  }
  EXPECT_EQ(kept.render(scene, view, options()).rgb, first.rgb);
  // Next to a deformed copy of itself.
  Scene two = scene;
  two = with_added(two, Node(*bent(scene, 0.4).roots[0]), NodeId::none, 1);
  Renderer fresh;
  EXPECT_EQ(kept.render(two, view, options()).rgb, fresh.render(two, view).rgb);
}

// The first object with every second texel of some rows made transparent, or opaque; other tiles stay shared.
Scene erased(const Scene& scene, int first_row, int last_row, bool opaque = false) {
  return with_changed(scene, scene.roots[0]->id, [&](Node& node) {
    auto object = std::make_shared<BakedObject>(*node.object);
    for (TextureSet& set : object->sets) {
      FeatureTexture::Change change(*set.texels);
      for (int y = first_row; y < last_row; ++y)
        for (int x = 0; x < set.texels->width(); x += 2) change.at(x, y).feat0[0] = opaque ? 200 : 0;
      set.texels = change.finish();
    }
    node.object = object;
  });
}

// The first object with random values in half of its features, which differ from texel to texel.
Scene recoloured(const Scene& scene) {
  return with_changed(scene, scene.roots[0]->id, [&](Node& node) {
    auto object = std::make_shared<BakedObject>(*node.object);
    for (TextureSet& set : object->sets) {
      FeatureTexture::Change change(*set.texels);
      std::mt19937 random(1);
      for (int y = 0; y < set.texels->height(); ++y)
        for (int x = 0; x < set.texels->width(); ++x)
          if (set.texels->opaque(x, y))
            for (std::uint8_t& channel : change.at(x, y).feat1) channel = static_cast<std::uint8_t>(random());
      set.texels = change.finish();
    }
    node.object = object;
  });
}

TEST_P(GpuSceneTest, ErasedTexelsMatchAFreshRenderer) {
  const Scene scene = scene_of(made_object({.columns = 64, .rows = 40}));
  const View view = small_view();
  Renderer kept;
  const Image first = kept.render(scene, view, options());
  const auto expect_new = [&](const Scene& next, const char* what) {
    EXPECT_EQ(kept.render(next, view, options()).rgb, Renderer().render(next, view).rgb) << what;
  };
  const Scene stroke = erased(scene, 0, 300);
  ASSERT_NE(Renderer().render(stroke, view).rgb, first.rgb) << "the stroke must change the picture";
  kept.prepare(stroke);
  expect_new(stroke, "a stroke");
  expect_new(erased(stroke, 280, 500), "another one");
  expect_new(scene, "both undone");
  const Scene moved = bent(stroke, 0.2);
  kept.prepare(moved);
  expect_new(moved, "a stroke and a bend at once");
  expect_new(erased(scene, 100, 700, true), "holes are filled: more triangles show than before");
  expect_new(recoloured(scene), "as many texels are opaque, and differ more");
  expect_new(scene, "and are there again");
}

// A stroke uploads the texels around it, not the whole texture.
TEST_P(GpuSceneTest, UploadsOnlyTexelsOfAStroke) {
  const auto context = gl::make_headless_context();
  const gl::CurrentContextScope current(*context);
  const Scene scene = scene_of(made_object({.columns = 64, .rows = 40}));
  GpuScene gpu;
  gpu.update(scene, GetParam());
  const std::uint64_t all = gpu.texels_uploaded();
  EXPECT_GT(all, 0U);
  gpu.update(bent(scene, 0.2), GetParam());
  EXPECT_EQ(gpu.texels_uploaded(), all) << "a bend changes no texel";
  const Scene stroke = erased(scene, 0, 20);
  gpu.update(stroke, GetParam());
  const std::uint64_t touched = gpu.texels_uploaded() - all;
  EXPECT_GT(touched, 0U);
  EXPECT_LT(touched, all / 2);
  gpu.update(stroke, GetParam());
  EXPECT_EQ(gpu.texels_uploaded(), all + touched) << "nothing changed";
}

// About 20 MB of texels, more than one slice uploads.
Scene large_scene(unsigned seed) { return scene_of(made_object({.columns = 128, .rows = 80, .seed = seed})); }

// As in the window when a scene is opened: it is uploaded in slices while another scene is still drawn.
TEST_P(GpuSceneTest, UploadInSlicesMatchesAFreshRenderer) {
  const Scene first = large_scene(1);
  Node beside;
  beside.object = large_scene(3).roots[0]->object;
  Scene second = with_added(first, beside, NodeId::none, 1);
  const View view = small_view();
  Renderer kept;
  const Image before = kept.render(first, view, options());
  double share = 0;
  int slices = 0;
  for (; share < 1 && slices < 10000; ++slices) {
    const double now = kept.upload_slice(second, 0);
    EXPECT_GE(now, share);
    share = now;
    EXPECT_EQ(kept.render(first, view, options()).rgb, before.rgb);
    if (slices == 2) second = bent(second, 0.2);  // another scene is wanted meanwhile, with the same texels
    if (slices == 4) kept.prepare(second);
  }
  EXPECT_EQ(share, 1);
  EXPECT_GT(slices, 10);
  EXPECT_EQ(kept.render(second, view, options()).rgb, Renderer().render(second, view).rgb);
  // A partly uploaded scene can be drawn; uploads of a scene that is no longer wanted are released.
  const Scene third = large_scene(5), fourth = large_scene(6);
  EXPECT_LT(kept.upload_slice(third, 0), 1);
  EXPECT_LT(kept.upload_slice(fourth, 0), 1);
  EXPECT_EQ(kept.render(third, view, options()).rgb, Renderer().render(third, view).rgb);
  EXPECT_EQ(kept.render(fourth, view, options()).rgb, Renderer().render(fourth, view).rgb);
  EXPECT_EQ(kept.upload_slice(third, 1e6), 1);
  EXPECT_EQ(kept.render(third, view, options()).rgb, Renderer().render(third, view).rgb);
}

// Uploaded data is not uploaded again, and released if no longer wanted. A stroke is left to update().
TEST_P(GpuSceneTest, UploadsOnceAndLeavesStrokesToUpdate) {
  const auto context = gl::make_headless_context();
  const gl::CurrentContextScope current(*context);
  const Scene scene = large_scene(1), other = large_scene(4);
  GpuScene gpu;
  const std::uint64_t nothing = gl::memory_use().now;
  EXPECT_EQ(gpu.upload_slice(scene, GetParam(), 1e6), 1);
  const std::uint64_t there = gl::memory_use().now;
  EXPECT_GT(there, nothing);
  gpu.update(scene, GetParam());
  EXPECT_EQ(gl::memory_use().now, there);
  const Scene stroke = erased(scene, 0, 20);
  EXPECT_EQ(gpu.upload_slice(stroke, GetParam(), 0), 1);
  EXPECT_EQ(gl::memory_use().now, there);
  EXPECT_LT(gpu.upload_slice(other, GetParam(), 0), 1);
  EXPECT_GT(gl::memory_use().now, there);
  EXPECT_EQ(gpu.upload_slice(scene, GetParam(), 0), 1);
  EXPECT_EQ(gl::memory_use().now, there) << "partial uploads of an unwanted scene must be released";
  gpu.upload_slice(other, GetParam(), 0);
  gpu.evict_staged();
  EXPECT_EQ(gl::memory_use().now, there) << "a cancelled upload must be released";
  gpu.upload_slice(other, GetParam(), 0);
  gpu.update(other, GetParam());
  EXPECT_LT(gl::memory_use().now, there + there / 2) << "drawn before the upload was complete";
}

// Each call uploads some data, even if the search for missing data takes longer than its time limit.
TEST_P(GpuSceneTest, UploadsManyNodes) {
  const auto context = gl::make_headless_context();
  const gl::CurrentContextScope current(*context);
  const auto shared = made_object({.columns = 8, .rows = 4});
  Scene scene;
  const auto add = [&](std::shared_ptr<const BakedObject> object) {
    auto node = std::make_shared<Node>();
    node->object = std::move(object);
    scene.roots.push_back(std::move(node));
  };
  for (int k = 0; k < 20000; ++k) add(shared);
  GpuScene gpu;
  EXPECT_EQ(gpu.upload_slice(scene, GetParam(), 0), 1) << "small data is uploaded in one call";
  for (unsigned k = 0; k < 300; ++k) add(made_object({.columns = 8, .rows = 4, .seed = k}));
  double share = 0;
  for (int call = 0; call < 1000 && share < 1; ++call) share = gpu.upload_slice(scene, GetParam(), 0);
  EXPECT_EQ(share, 1);
}

TEST_P(GpuSceneTest, PreparedClustersOfFewerFacesAreNotReused) {
  const Scene full = scene_of(made_object({.columns = 64, .rows = 40}));
  const Scene holes = erased(full, 0, 600);
  const View view = small_view();
  Renderer kept;
  kept.render({}, view, options());
  const Scene bent_holes = bent(holes, 0.3);
  kept.prepare(bent_holes);            // clusters of the faces with opaque texels
  kept.render(full, view, options());  // its surface then replaces that of the scene with holes
  RenderOptions with_occlusion = options();
  with_occlusion.occlusion = RenderOptions::Occlusion::on;
  EXPECT_EQ(kept.render(bent_holes, view, with_occlusion).rgb, Renderer().render(bent_holes, view).rgb);
}

// Each texel that a triangle may show is packed where the shader reads it; unused texels are not uploaded.
TEST(PackedTexels, ContainVisibleTexelsOnly) {
  const auto object = made_object({.columns = 64, .rows = 40});
  TextureSet set = object->sets[0];
  for (const bool half : {false, true}) {
    if (half) {
      TriangleSet keep(set.soup.triangle_count(), 0);
      for (std::size_t f = 0; f < keep.size(); ++f) keep[f] = f / 2 % 2 == 0 ? 1 : 0;
      set.soup = subset(set.soup, keep, 0, true);
    }
    const PreparedSurface surface = prepared_surface(set, false);
    const TexelPacking& packing = *surface.packing;
    std::vector<Texel> here;
    const TexelReader texels(*set.texels);
    fill_packed_rows(packing, texels, 0, packing.height, here);
    for (const Face& face : *surface.shown.faces) {
      const SurfaceVertex &a = surface.vertices[face[0]], &b = surface.vertices[face[1]],
                          &c = surface.vertices[face[2]];
      EXPECT_TRUE(a.place == b.place && a.place == c.place);
      for (const auto& [u, v, w] : {std::tuple(1.0F, 0.0F, 0.0F), {0.0F, 1.0F, 0.0F}, {0.3F, 0.3F, 0.4F}}) {
        const int x = static_cast<int>(a.texel[0] * u + b.texel[0] * v + c.texel[0] * w),
                  y = static_cast<int>(a.texel[1] * u + b.texel[1] * v + c.texel[1] * w);
        ASSERT_TRUE(x >= a.first_texel[0] && x <= a.last_texel[0] && y >= a.first_texel[1] && y <= a.last_texel[1]);
        ASSERT_EQ(
            here[static_cast<std::size_t>(y - a.first_texel[1] + a.place[1]) * static_cast<std::size_t>(packing.width) +
                 static_cast<std::size_t>(x - a.first_texel[0] + a.place[0])],
            texels.at(x, y));
      }
    }
    const double share = static_cast<double>(packing.width) * packing.height /
                         (static_cast<double>(set.texels->width()) * set.texels->height());
    if (half) {
      EXPECT_LT(share, 0.55);
      EXPECT_FALSE(packing.whole);
    }
  }
}

}  // namespace
}  // namespace rebake::test
