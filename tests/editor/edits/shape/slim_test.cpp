// Slimming removes only invisible triangles: pictures from all permitted eye positions stay the same.
#include "editor/edits/shape/slim.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "editor/edits/nodes/view.h"
#include "editor/edits/select/select.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/features/atlas/slimming.h"
#include "mesh_ops/index/texel_patches.h"
#include "mesh_ops/light/transport/light_chart.h"
#include "render/compare.h"
#include "render/picture.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

// A closed sphere inside another one, of which `opening` triangles are missing.
std::shared_ptr<const BakedObject> nested(std::size_t opening = 0) {
  auto object = std::make_shared<BakedObject>(*made_object({.columns = 32, .rows = 16, .holes = false}));
  const TextureSet inner = made_object({.columns = 16, .rows = 8, .seed = 1, .radius = 0.5, .holes = false})->sets[0];
  if (opening > 0) {
    TriangleSet gone(object->sets[0].soup.triangle_count(), 0);
    const std::size_t first = gone.size() / 2;
    std::fill_n(gone.begin() + static_cast<std::ptrdiff_t>(first), opening, 1);
    object->sets[0].soup = subset(object->sets[0].soup, gone, 0, false);
  }
  object->sets.push_back(inner);
  return object;
}

View view_from(const Vec3& eye) {
  View view;
  view.camera.eye = eye;
  view.camera.near_plane = 0.05;
  view.camera.far_plane = 20;
  view.width = view.height = 160;
  return view;
}

// Number of pixels that differ between two pictures of 160².
std::size_t differing(const Image& a, const Image& b) {
  std::size_t pixels = 0;
  for (std::size_t k = 0; k < a.rgb.size(); k += 3) pixels += std::equal(&a.rgb[k], &a.rgb[k] + 3, &b.rgb[k]) ? 0 : 1;
  return pixels;
}

// Of 25,600 pixels: at silhouettes, rounding decides whether a sample shows the near or the far triangle.
constexpr std::size_t max_differing = 4;

std::string joined(const Report& report) {
  std::string all;
  for (const std::string& line : report.lines) all += line + "\n";
  return all;
}

TEST(Slim, RemovesHiddenTrianglesAndKeepsPictures) {
  const Scene scene = scene_of(nested());
  const Outcome slim = apply(scene, Edit(Slim{}));
  const BakedObject& before = *scene.roots[0]->object;
  const BakedObject& after = *slim.scene.roots[0]->object;
  EXPECT_EQ(after.triangle_count(), before.sets[0].soup.triangle_count()) << joined(slim.report);
  EXPECT_TRUE(after.bodies.empty()) << "light must stay as baked";
  std::uint64_t texels_before = 0, texels_after = 0;
  for (const TextureSet& set : before.sets)
    texels_before += static_cast<std::uint64_t>(set.texels->width()) * static_cast<std::uint64_t>(set.texels->height());
  for (const TextureSet& set : after.sets)
    texels_after += static_cast<std::uint64_t>(set.texels->width()) * static_cast<std::uint64_t>(set.texels->height());
  EXPECT_LT(texels_after, texels_before);
  Renderer renderer;
  for (int k = 0; k < 8; ++k) {
    const double turn = 0.8 * k;
    const View view = view_from({3 * std::sin(turn), 2 * std::cos(3 * turn), 3 * std::cos(turn)});
    EXPECT_EQ(renderer.render(scene, view).rgb, renderer.render(slim.scene, view).rgb) << k;
  }
  EXPECT_NE(joined(slim.report).find("256 unseen"), std::string::npos) << joined(slim.report);
  EXPECT_NE(joined(slim.report).find("2048 from each removed triangle"), std::string::npos) << joined(slim.report);
  EXPECT_NE(joined(slim.report).find("at most 0.42 %"), std::string::npos) << "1 - (0.05 / 256)^(1 / 2048)";
}

TEST(Slim, SaysThatTransparentTrianglesNeededNoRays) {
  auto object = std::make_shared<BakedObject>(*nested());
  const FeatureTexture& inner = *object->sets[1].texels;
  object->sets[1].texels = std::make_shared<const FeatureTexture>(
      FeatureTexture::from_rows(inner.width(), inner.height(), inner.alpha_code(),
                                [&](int, Texel* row) { std::fill_n(row, inner.width(), Texel{}); }));
  const std::string said = joined(apply(scene_of(object), Edit(Slim{})).report);
  EXPECT_NE(said.find("256 unseen, 0 duplicates"), std::string::npos) << said;
  EXPECT_NE(said.find("the removed triangles have no opaque texels"), std::string::npos) << said;
}

TEST(Slim, KeepsTrianglesVisibleThroughASmallOpening) {
  const auto object = nested(2);
  const VisibilityReport seen = traced_visibility(*object, {}, 4096);
  std::size_t inner_seen = 0;
  const std::size_t outer = object->sets[0].soup.triangle_count();
  for (std::size_t f = outer; f < seen.unseen.size(); ++f) inner_seen += seen.unseen[f] == 0 ? 1 : 0;
  EXPECT_GT(inner_seen, 10U);
  EXPECT_LT(seen.smallest_opening, 0.01) << "the opening is 2 of 1024 triangles";
  EXPECT_GT(seen.rays, 4096U);
  Slim edit;
  edit.rays = 4096;
  const Scene scene = scene_of(object);
  const Scene slim = apply(scene, Edit(edit)).scene;
  // A view straight through the opening.
  const auto whole = nested();
  const Soup& soup = whole->sets[0].soup;
  const Vec3 middle = soup.positions()[soup.faces()[outer / 2][0]].normalized();
  Renderer renderer;
  const View through = view_from(3 * middle);
  EXPECT_LE(differing(renderer.render(scene, through), renderer.render(slim, through)), max_differing);
}

TEST(Slim, RemovesTheFarSideForLimitedEyes) {
  const Scene scene = scene_of(made_object({.columns = 32, .rows = 16, .holes = false}));
  Slim in_box;
  in_box.eyes = BoxRegion{{-0.5, -0.5, 2.5}, {0.5, 0.5, 3.5}};
  in_box.rays = 2048;
  Renderer renderer;
  const Outcome boxed = apply(scene, Edit(in_box));
  const std::size_t all = scene.roots[0]->object->triangle_count();
  EXPECT_LT(boxed.scene.roots[0]->object->triangle_count(), all * 6 / 10);
  for (const Vec3& eye : {Vec3(0.4, 0.4, 2.6), Vec3(-0.5, 0, 3.5), Vec3(0, -0.5, 3)})
    EXPECT_LE(differing(renderer.render(scene, view_from(eye)), renderer.render(boxed.scene, view_from(eye))),
              max_differing);
  EXPECT_NE(renderer.render(scene, view_from({0, 0, -3})).rgb, renderer.render(boxed.scene, view_from({0, 0, -3})).rgb)
      << "the far side must be removed";

  StoreView store;
  store.name = "front";
  store.camera = view_from({0, 0, 3}).camera;
  Scene with_view = apply(scene, Edit(store)).scene;
  Slim by_view;
  by_view.views = {"front"};
  by_view.rays = 2048;
  with_view = apply(with_view, Edit(by_view)).scene;
  EXPECT_LT(with_view.roots[0]->object->triangle_count(), all / 2);
  const View front = view_from({0, 0, 3});
  EXPECT_LE(differing(renderer.render(scene, front), renderer.render(with_view, front)), max_differing);
}

TEST(Slim, UsesTheAllowedPsnr) {
  const Scene scene = scene_of(made_object({.columns = 32, .rows = 16, .holes = false}));
  Renderer renderer;
  int sum_before = 64;
  for (const double psnr : {50.0, 40.0, 30.0}) {
    const BitsFound found = fewest_bits(*scene.roots[0]->object, psnr);
    EXPECT_GE(found.psnr_db, psnr);
    EXPECT_LT(found.psnr_db, psnr + 6) << "removing one more bit costs at most 6 dB";
    int sum = 0;
    for (const int bits : found.bits) sum += bits;
    EXPECT_LT(sum, sum_before);
    sum_before = sum;
    Slim edit;
    edit.psnr = psnr;
    const Scene slim = apply(scene, Edit(edit)).scene;
    const Difference d =
        compare(renderer.render(scene, view_from({1, 1, 3})), renderer.render(slim, view_from({1, 1, 3})), 2);
    EXPECT_GE(d.psnr_db, psnr - 1) << "pictures must have about the PSNR of texels";
    EXPECT_EQ(slim.roots[0]->object->opaque_texel_count(), scene.roots[0]->object->opaque_texel_count());
  }
}

// A sphere on which each patch has the texels of the first one, with one byte per texel changed by ±1.
std::shared_ptr<const BakedObject> sphere_of_similar_patches() {
  auto object = std::make_shared<BakedObject>(*made_object({.columns = 32, .rows = 16, .holes = false}));
  TextureSet& set = object->sets[0];
  const TexelPatches patches = texel_patches(set);
  const TexelRect& first = patches.rects.front();
  const TexelReader texels(*set.texels);
  FeatureTexture::Change change(*set.texels);
  for (std::size_t p = 1; p < patches.rects.size(); ++p) {
    const TexelRect& rect = patches.rects[p];
    for (int y = 0; y < rect.height(); ++y)
      for (int x = 0; x < rect.width(); ++x) {
        Texel texel = texels.at(first.left + x, first.top + y);
        std::uint8_t& value = texel.feat1[p % 3];
        value = static_cast<std::uint8_t>(std::clamp(value + (p % 2 == 0 ? 1 : -1), 1, 255));
        change.at(rect.left + x, rect.top + y) = texel;
      }
  }
  set.texels = change.finish();
  return object;
}

TEST(Slim, SimilarPatchesShareTexels) {
  const Scene scene = scene_of(sphere_of_similar_patches());
  Slim edit;
  edit.psnr = 40;
  const Outcome slim = apply(scene, Edit(edit));
  const BakedObject &before = *scene.roots[0]->object, &after = *slim.scene.roots[0]->object;
  EXPECT_EQ(after.triangle_count(), before.triangle_count());
  EXPECT_LT(after.opaque_texel_count() * 100, before.opaque_texel_count()) << joined(slim.report);
  EXPECT_NE(joined(slim.report).find("511 of 512 texel patches"), std::string::npos) << joined(slim.report);
  Renderer renderer;
  for (const Vec3& eye : {Vec3(1, 1, 3), Vec3(-2, 1, -2)}) {
    const Difference d =
        compare(renderer.render(scene, view_from(eye)), renderer.render(slim.scene, view_from(eye)), 2);
    EXPECT_GE(d.psnr_db, 39);
  }
  // Patches that differ do not share texels.
  const Scene other = scene_of(made_object({.columns = 16, .rows = 8, .holes = false}));
  edit.psnr = 60;
  EXPECT_EQ(joined(apply(other, Edit(edit)).report).find("texel patches use those of near-duplicates"),
            std::string::npos);
}

// Surfaces that share texels get light nodes of their own.
TEST(Slim, SurfacesWithSharedTexelsHaveOwnLightNodes) {
  Slim edit;
  edit.psnr = 40;
  const Scene slim = apply(scene_of(sphere_of_similar_patches()), Edit(edit)).scene;
  const TextureSet& set = slim.roots[0]->object->sets[0];
  ASSERT_EQ(texel_patches(set).rects.size(), 1U);
  const LightChart chart = light_chart(set, 4);
  std::set<std::uint32_t> lit;
  for (const LightChart::Node& node : chart.nodes) lit.insert(node.face / 2);
  EXPECT_EQ(lit.size(), set.soup.triangle_count() / 2) << "each quad has nodes";
}

TEST(Slim, IsTheSameAtAnyNumberOfThreads) {
  const auto object = nested(2);
  const VisibilityReport many = traced_visibility(*object, {}, 64);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const VisibilityReport alone = traced_visibility(*object, {}, 64);
  EXPECT_EQ(many.unseen, alone.unseen);
  EXPECT_EQ(many.rays, alone.rays);
}

TEST(Slim, KeepsObjectsShared) {
  Scene scene = scene_of(nested());
  Node copy;
  copy.object = scene.roots[0]->object;
  copy.to_parent = Eigen::Translation3d(3, 0, 0) * Eigen::AngleAxisd(3.14159, Vec3::UnitY());
  scene = with_added(scene, copy, NodeId::none, 9);
  const Scene slim = apply(scene, Edit(Slim{})).scene;
  EXPECT_EQ(slim.roots[0]->object, slim.roots[1]->object);
  const std::string said = joined(apply(scene, Edit(Slim{})).report);
  EXPECT_NE(said.find("and 1 node that shares its object: 256 of 1280 triangles removed in each"), std::string::npos)
      << said;
  // The eyes see the front of one node and the back of the other, so both sides of the shared object stay.
  Slim front;
  front.eyes = BoxRegion{{-0.1, -0.1, 3}, {0.1, 0.1, 3.1}};
  front.rays = 512;
  const Scene both = apply(scene, Edit(front)).scene;
  Slim one = front;
  one.node = NodeRef{scene.roots[0]->id};
  EXPECT_GT(both.roots[0]->object->triangle_count(), apply(scene, Edit(one)).scene.roots[0]->object->triangle_count());
}

// One of two equal triangles stays, whichever of them rays hit.
TEST(Slim, KeepsStoredSelectionsThatKeyframesBend) {
  const auto bent = [](const char* selection) {
    Scene scene = scene_of(nested());
    return with_changed(scene, scene.roots[0]->id, [&](Node& node) {
      node.saved_selections["arm"] = std::make_shared<const TriangleSet>(node.object->triangle_count(), 1);
      NodeMotion motion;
      motion.bends["sway"].selection = selection;
      motion.bends["sway"].degrees = {{0, 10}};
      node.motion = std::make_shared<const NodeMotion>(motion);
    });
  };
  Slim front;  // the far side goes, so that repacking is worth it
  front.eyes = BoxRegion{{-0.1, -0.1, 3}, {0.1, 0.1, 3.1}};
  front.rays = 512;
  const auto slimmed = [&](const Scene& scene) { return carry_out(scene, Edit(front), {}); };
  ASSERT_TRUE(slimmed(bent("")).scene.roots[0]->saved_selections.empty()) << "repacking changes the order";
  const Outcome kept = slimmed(bent("arm"));
  ASSERT_TRUE(kept.scene.roots[0]->saved_selections.contains("arm"));
  EXPECT_EQ(kept.scene.roots[0]->saved_selections.at("arm")->size(), kept.scene.roots[0]->object->triangle_count());
  std::string said;
  for (const std::string& line : kept.report.lines) said += line + "\n";
  EXPECT_NE(said.find("visibility was computed at rest"), std::string::npos) << said;
}

TEST(Slim, KeepsOneOfEqualTriangles) {
  auto object = std::make_shared<BakedObject>(*made_object({.columns = 32, .rows = 16, .holes = false}));
  const std::size_t single = object->triangle_count();
  std::vector<Face> twice = object->sets[0].soup.faces();
  twice.insert(twice.end(), object->sets[0].soup.faces().begin(), object->sets[0].soup.faces().end());
  object->sets[0].soup = Soup(object->sets[0].soup.positions(), object->sets[0].soup.uvs(), twice);
  EXPECT_EQ(apply(scene_of(object), Edit(Slim{})).scene.roots[0]->object->triangle_count(), single);
}

TEST(Slim, ReportsAnEmptySelection) {
  Select all;
  all.all = true;
  const Scene scene = apply(scene_of(nested()), Edit(all)).scene;
  const Outcome slim = apply(scene, Edit(Slim{}));
  EXPECT_EQ(slim.scene.roots[0]->selection, nullptr);
  EXPECT_NE(joined(slim.report).find("the selection was cleared"), std::string::npos) << joined(slim.report);
}

TEST(Slim, SlimmingTwiceChangesNothing) {
  const Scene scene = scene_of(made_object({.columns = 32, .rows = 16, .holes = false}));
  const Scene once = apply(scene, Edit(Slim{})).scene;
  EXPECT_EQ(apply(once, Edit(Slim{})).scene.roots[0]->object, once.roots[0]->object);
}

TEST(Slim, ErrorsNameTheField) {
  const Scene scene = scene_of(nested());
  const auto error_of = [&](const Slim& edit) -> std::string {
    try {
      apply(scene, Edit(edit));
      return "";
    } catch (const Error& error) {
      return error.what();
    }
  };
  Slim edit;
  edit.rays = 3;
  EXPECT_NE(error_of(edit).find("rays"), std::string::npos);
  edit = {};
  edit.psnr = 200;
  EXPECT_NE(error_of(edit).find("psnr"), std::string::npos);
  edit = {};
  edit.views = {"nowhere"};
  EXPECT_NE(error_of(edit).find("nowhere"), std::string::npos);
  edit = {};
  edit.eyes = BoxRegion{{0, 0, 0}, {0, 0, 0}};  // at the centre of the inner sphere, which alone is visible
  EXPECT_EQ(error_of(edit), "");
  edit.eyes = BoxRegion{{1, 0, 0}, {0, 0, 0}};
  EXPECT_NE(error_of(edit).find("eyes"), std::string::npos);
}

}  // namespace
}  // namespace rebake::test
