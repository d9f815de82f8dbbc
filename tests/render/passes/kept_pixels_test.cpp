// If only texels changed, only pixels that may show them are drawn again. Pictures must equal complete ones to the
// byte, and other pixels must not be drawn.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "mesh_ops/light/lighting.h"
#include "render/graph/effects.h"
#include "render/picture.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

struct RedrawPair {
  Renderer whole, kept;

  static PlannedPass said(const Renderer& renderer) {
    for (const PlannedPass& pass : renderer.passes())
      if (pass.effect == &effects::kept_pixels) return pass;
    return {};
  }
  // Draws completely and with reuse, and compares; returns whether pixels were reused.
  bool expect_same(const Scene& scene, const View& view, const std::string& what, const Guides* guides = nullptr,
                   RenderOptions options = {}) {
    // Another view first, so that nothing can be reused.
    View other = view;
    other.width = other.height = 16;
    whole.render(scene, other, options);
    const auto picture = [&](Renderer& renderer) {
      if (guides == nullptr) return renderer.render(scene, view, options);
      renderer.show(scene, view, options, *guides, false);
      return renderer.shown_image();
    };
    const Image expected = picture(whole), drawn = picture(kept);
    EXPECT_FALSE(said(whole).runs);
    EXPECT_TRUE(expected.rgb == drawn.rgb) << what << ": " << said(kept).why;
    return said(kept).runs;
  }
};

View from_front(int samples = 4) {
  View view;
  view.camera.eye = {0.4, 0.6, 6.5};  // far enough that the scene covers less than a third of the picture
  view.camera.near_plane = 0.1;
  view.camera.far_plane = 50;
  view.width = 200;
  view.height = 150;
  view.samples = samples;
  return view;
}

std::shared_ptr<const BakedObject> with_texels(const BakedObject& object,
                                               std::shared_ptr<const FeatureTexture> texels) {
  auto changed = std::make_shared<BakedObject>(object);
  changed->sets[0].texels = std::move(texels);
  return changed;
}

// Inverts the opacity of a square of texels.
std::shared_ptr<const FeatureTexture> stroked(const FeatureTexture& texels, int x, int y, int size) {
  FeatureTexture::Change change(texels);
  for (int v = y; v < std::min(y + size, texels.height()); ++v)
    for (int u = x; u < std::min(x + size, texels.width()); ++u) {
      Texel& texel = change.at(u, v);
      texel.feat0[0] = texel.feat0[0] == 0 ? 200 : 0;
    }
  return change.finish();
}

// One object twice, the second with a rotation and a mirroring scale; another object behind them.
Scene three(const std::shared_ptr<const BakedObject>& object, const std::shared_ptr<const BakedObject>& behind) {
  Scene scene;
  const auto add = [&](const std::shared_ptr<const BakedObject>& shown, const Affine& place) {
    Node node;
    node.object = shown;
    node.to_parent = place;
    scene = with_added(scene, node, NodeId::none, 99);
  };
  add(object, Affine(Eigen::Translation3d(-0.7, 0, 0)));
  add(object, Eigen::Translation3d(0.8, 0, 0.2) * Eigen::AngleAxisd(1.9, Vec3(1, 2, 0).normalized()) *
                  Affine(Eigen::Scaling(0.6, -0.8, 0.7)));
  add(behind, Affine(Eigen::Translation3d(0, 0.3, -1.5)));
  return scene;
}

TEST(KeptPixels, PartialRedrawMatchesFullRedraw) {
  RedrawPair pair;
  const auto behind = made_object({.seed = 3});
  for (const int samples : {1, 4}) {
    for (const bool orthographic : {false, true}) {
      auto object = made_object({.columns = 40, .rows = 20});
      const auto first = object->sets[0].texels;
      View view = from_front(samples);
      if (orthographic) view.camera.ortho_height = 4.5;
      std::mt19937 random(5);
      pair.expect_same(three(object, behind), view, "at first");
      int kept = 0;
      constexpr int strokes = 24;
      for (int k = 0; k < strokes; ++k) {
        const auto& texels = *object->sets[0].texels;
        const int x = static_cast<int>(random() % static_cast<unsigned>(texels.width())),
                  y = static_cast<int>(random() % static_cast<unsigned>(texels.height()));
        object = with_texels(*object, stroked(texels, x, y, k % 5 == 0 ? 60 : 5));
        kept += pair.expect_same(three(object, behind), view,
                                 fmt::format("{} samples, stroke {} at {}, {}", samples, k, x, y))
                    ? 1
                    : 0;
      }
      EXPECT_GT(kept, strokes / 2);
      // All strokes undone at once.
      pair.expect_same(three(with_texels(*object, first), behind), view, "as at first");
    }
  }
}

TEST(KeptPixels, SelectionAndLinesStayCorrect) {
  RedrawPair pair;
  const auto behind = made_object({.seed = 3});
  auto object = made_object({.columns = 40, .rows = 20});
  Guides guides;
  guides.lines = {{{-2, -1, 0.3}, {2, 1, 0.4}, {1, 0, 0}, 0.8, 0.3}, {{-2, 0, -1}, {2, 0.2, 1}, {0, 1, 0}, 1, 0.4}};
  std::mt19937 random(9);
  // All scenes share one selection, as after edits that do not change it.
  const auto selection = std::make_shared<TriangleSet>(object->triangle_count(), 0);
  for (std::size_t f = 0; f < selection->size(); f += 3) (*selection)[f] = 1;
  const auto scene = [&] {
    Scene made = three(object, behind);
    made = with_changed(made, made.roots[0]->id, [&](Node& node) { node.selection = selection; });
    return made;
  };
  guides.outlined = {scene().roots[1]->id, scene().roots[2]->id};
  pair.expect_same(scene(), from_front(), "at first", &guides);
  int kept = 0;
  for (int k = 0; k < 12; ++k) {
    const auto& texels = *object->sets[0].texels;
    object = with_texels(*object, stroked(texels, static_cast<int>(random() % static_cast<unsigned>(texels.width())),
                                          static_cast<int>(random() % static_cast<unsigned>(texels.height())), 25));
    kept += pair.expect_same(scene(), from_front(), fmt::format("stroke {}", k), &guides) ? 1 : 0;
  }
  EXPECT_GT(kept, 4);
  guides.lines.pop_back();
  EXPECT_FALSE(pair.expect_same(scene(), from_front(), "other lines", &guides));
  EXPECT_FALSE(pair.expect_same(scene(), from_front(), "without lines"));
}

TEST(KeptPixels, OtherChangesRedrawEverything) {
  RedrawPair pair;
  const auto behind = made_object({.seed = 3}), object = made_object({.columns = 40, .rows = 20});
  const auto stroke = with_texels(*object, stroked(*object->sets[0].texels, 40, 40, 20));
  const Scene before = three(object, behind), after = three(stroke, behind);
  const auto then = [&](const Scene& first, const View& view_before, const Scene& second, const View& view,
                        const std::string& what) {
    pair.expect_same(first, view_before, what + ", before");
    return pair.expect_same(second, view, what);
  };
  View other = from_front();
  other.camera.eye.x() += 1e-9;
  EXPECT_TRUE(then(before, from_front(), after, from_front(), "a stroke"));
  EXPECT_FALSE(then(before, from_front(), after, other, "a stroke and a step"));
  EXPECT_FALSE(then(before, from_front(), before, from_front(), "nothing"));
  Scene moved = with_changed(after, after.roots[2]->id, [](Node& node) { node.to_parent.translation().x() += 1e-3; });
  EXPECT_FALSE(then(before, from_front(), moved, from_front(), "a stroke and a move"));
  Scene shown = after;
  shown.background = {0.2, 0.3, 0.4};
  EXPECT_FALSE(then(before, from_front(), shown, from_front(), "a stroke and another background"));
  EXPECT_FALSE(then(before, from_front(), three(behind, stroke), from_front(), "objects that change places"));
  EXPECT_FALSE(then(before, from_front(4), after, from_front(1), "a stroke and other samples"));
}

TEST(KeptPixels, ChangesOutsideTheViewRedrawNothing) {
  RedrawPair pair;
  const auto behind = made_object({.seed = 3}), object = made_object({.columns = 40, .rows = 20});
  View view = from_front();
  // A view past the object whose texels change.
  view.camera.eye = {0, 0.3, 0.4};
  view.camera.target = {0, 0.3, -1.5};
  Scene scene = three(object, behind);
  scene =
      with_changed(scene, scene.roots[0]->id, [](Node& node) { node.to_parent.translation() = Vec3(-0.9, 0, -0.5); });
  pair.expect_same(scene, view, "at first");
  std::mt19937 random(2);
  auto texels = object->sets[0].texels;
  bool none = false;
  for (int k = 0; k < 16; ++k) {
    texels = stroked(*texels, static_cast<int>(random() % static_cast<unsigned>(texels->width())),
                     static_cast<int>(random() % static_cast<unsigned>(texels->height())), 3);
    const Scene next =
        with_changed(scene, scene.roots[0]->id, [&](Node& node) { node.object = with_texels(*object, texels); });
    EXPECT_TRUE(pair.expect_same(next, view, fmt::format("stroke {}", k)));
    none = none || RedrawPair::said(pair.kept).why.find("in 0×0") != std::string::npos;
  }
  EXPECT_TRUE(none);
}

}  // namespace
}  // namespace rebake::test
