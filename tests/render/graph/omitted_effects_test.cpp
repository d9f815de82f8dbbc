// Effects that a frame omits because their change is invisible: view directions that a decoder ignores, and
// supersampling if everything has one colour. Compared with pictures of all effects.
#include <gtest/gtest.h>

#include "render/compare.h"
#include "render/graph/effects.h"
#include "render/picture.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

// A made object with a changed decoder.
template <class Change>
std::shared_ptr<const BakedObject> with_decoder(Change change) {
  auto object = std::make_shared<BakedObject>(*made_object());
  Decoder decoder = *object->decoder;
  change(decoder);
  object->decoder = std::make_shared<const Decoder>(std::move(decoder));
  return object;
}

View left_out_view() {
  View view;
  view.width = view.height = 96;
  view.camera.eye = {1.5, 1, 2.5};
  return view;
}

// The largest difference from the picture with all effects, in 1/255.
double unseen_difference(const Scene& scene, const View& view) {
  static Renderer renderer;
  RenderOptions all;
  all.everything = true;
  EXPECT_EQ(plan(scene, view, all).left_out, 0);
  return compare(renderer.render(scene, view), renderer.render(scene, view, all), 0).largest;
}

TEST(OmittedEffects, OmitsUnusedViewDirections) {
  const auto blind = with_decoder([](Decoder& d) { d.weights0.bottomRows(3).setZero(); });
  Scene scene = scene_of(blind);
  Node turned;
  turned.object = blind;
  turned.to_parent = Eigen::Translation3d(0.4, 0, 0) * Eigen::AngleAxisd(0.7, Vec3::UnitX());
  scene = with_added(scene, std::move(turned), NodeId::none, 1);
  const View view = left_out_view();
  const FramePlan planned = plan(scene, view);
  EXPECT_FALSE(planned.runs(effects::view_direction));
  EXPECT_FALSE(planned.runs(effects::node_frames)) << "orientations have no effect then";
  EXPECT_EQ(planned.left_out, 0);
  EXPECT_EQ(unseen_difference(scene, view), 0);
}

TEST(OmittedEffects, OmitsInvisibleInfluenceOfViewDirections) {
  for (const double size : {1e-9, 1e-7, 1e-5, 1e-2, 1.0}) {
    const Scene scene = scene_of(with_decoder([&](Decoder& d) { d.weights0.bottomRows(3) *= size; }));
    const FramePlan planned = plan(scene, left_out_view());
    EXPECT_EQ(planned.runs(effects::view_direction), planned.direction_change > unseen) << size;
    EXPECT_LE(planned.left_out, unseen) << size;
    EXPECT_LE(unseen_difference(scene, left_out_view()), planned.left_out * 255 + 1) << size;
  }
  EXPECT_TRUE(plan(scene_of(made_object()), left_out_view()).runs(effects::view_direction));
}

TEST(OmittedEffects, OmitsSupersamplingOfOneColour) {
  // For small `weights` the decoder gives (¾, ½, ¼) for any input.
  const auto constant = [](double weights) {
    auto object = std::make_shared<BakedObject>(*with_decoder([&](Decoder& d) {
      d.weights2 *= weights;
      d.bias2 = Vec3(std::log(3.0), 0, -std::log(3.0));
    }));
    const auto old = object->sets[0].texels;
    // The same features everywhere, with the same holes.
    object->sets[0].texels = std::make_shared<const FeatureTexture>(
        FeatureTexture::from_rows(old->width(), old->height(), old->alpha_code(), [&](int y, Texel* row) {
          for (int x = 0; x < old->width(); ++x)
            row[x] = old->opaque(x, y) ? Texel{{90, 80, 70, 200}, {60, 50, 40, 190}} : empty_texel(old->alpha_code());
        }));
    return object;
  };
  Scene scene = scene_of(constant(1e-6));
  scene.background = {0.75, 0.5, 0.25};
  const FramePlan planned = plan(scene, left_out_view());
  EXPECT_FALSE(planned.runs(effects::supersampling));
  EXPECT_EQ(planned.view.samples, 1);
  EXPECT_LE(unseen_difference(scene, left_out_view()), planned.left_out * 255 + 1);
  // With another background edges are visible; with larger weights features change colours.
  Scene other = scene;
  other.background = {0.75, 0.5, 0.26};
  EXPECT_TRUE(plan(other, left_out_view()).runs(effects::supersampling));
  Scene seen = scene_of(constant(1));
  seen.background = scene.background;
  EXPECT_TRUE(plan(seen, left_out_view()).runs(effects::supersampling));
}

}  // namespace
}  // namespace rebake::test
