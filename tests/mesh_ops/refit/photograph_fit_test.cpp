// Features fitted to photographs: colours come back, what no photograph sees stays, and results repeat.
#include "mesh_ops/refit/photograph_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh_ops/index/index.h"
#include "mesh_ops/refit/texel_observations.h"
#include "render/picture.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

class PhotographFit : public ::testing::Test {
 protected:
  PhotographFit() : scene_(scene_of(with_texels(*made_object({.columns = 8, .rows = 4, .holes = false}), smooth))) {
    Renderer renderer;
    for (int k = 0; k < 12; ++k) {
      View view;
      const double turn = k * 2.4, height = -1 + 2 * (k + 0.5) / 12, flat = std::sqrt(1 - height * height);
      view.camera.eye = 5 * Vec3(flat * std::cos(turn), height, flat * std::sin(turn));
      view.width = view.height = side;
      const Box box = world_bounds(scene_);
      view.camera = with_planes(view.camera, box, 1);
      photographs_.push_back(
          {view.camera, side, side, renderer.render(scene_, view).rgb, std::vector<std::uint8_t>(side * side, 1)});
    }
  }
  // Colours that vary over many texels, so that photographs resolve them.
  static Texel smooth(int x, int y) {
    const auto byte = [](double value) { return static_cast<std::uint8_t>(std::lround(128 + 100 * value)); };
    const double a = std::sin(x / 200.0), b = std::sin(y / 150.0);
    return {{byte(a), byte(b), byte(a * b), 200}, {byte(-a), byte(-b), byte(0.5 * a), 180}};
  }
  static Texel grey(int, int) { return {{128, 128, 128, 192}, {128, 128, 128, 192}}; }
  static std::shared_ptr<const BakedObject> with_texels(const BakedObject& object, Texel (*texel)(int x, int y)) {
    auto made = std::make_shared<BakedObject>(object);
    for (TextureSet& set : made->sets) {
      FeatureTexture::Change change(*set.texels);
      for (int y = 0; y < set.texels->height(); ++y)
        for (int x = 0; x < set.texels->width(); ++x) change.at(x, y) = texel(x, y);  // without holes
      set.texels = change.finish();
    }
    return made;
  }
  const BakedObject& object() const { return *placed_nodes(scene_).front().node->object; }
  FitOfPhotographs fit(const Scene& scene, const TriangleSet* chosen = nullptr, bool decoder = false) const {
    const std::vector<PlacedNode> placed = placed_nodes(scene);
    FitOfPhotographsOptions options;
    options.decoder = decoder;
    options.epochs = 30;
    const TriangleSet all(placed[0].node->object->triangle_count(), 1);
    return fit_to_photographs({{placed[0], chosen != nullptr ? *chosen : all}}, rays_through(placed), photographs_,
                              options, {});
  }
  static constexpr int side = 160;
  Scene scene_;
  std::vector<FitPhotograph> photographs_;
};

TEST_F(PhotographFit, ColoursComeBackFromGrey) {
  const Scene reset = scene_of(with_texels(object(), grey));
  for (const bool decoder : {false, true}) {
    const FitOfPhotographs fitted = fit(reset, nullptr, decoder);
    EXPECT_GT(fitted.seen, 1000U);
    EXPECT_GT(fitted.before, 12.0 / 255);
    EXPECT_LT(fitted.after, 0.5 * fitted.before) << decoder;
    // Equal in every run.
    const FitOfPhotographs again = fit(reset, nullptr, decoder);
    EXPECT_EQ(fitted.after, again.after);
  }
}

TEST_F(PhotographFit, ItsOwnPicturesHardlyChangeAScene) {
  const FitOfPhotographs fitted = fit(scene_);
  EXPECT_LE(fitted.after, fitted.before) << fitted.seen << " " << fitted.unseen;
  EXPECT_LT(fitted.after, 8.0 / 255) << "photographs are blurred by their pixels";
}

TEST_F(PhotographFit, OnlyTexelsOfChosenTrianglesChange) {
  TriangleSet some(object().triangle_count(), 0);
  for (std::size_t f = 0; f < 6; ++f) some[f] = 1;
  const Scene reset = scene_of(with_texels(object(), grey));
  const FitOfPhotographs fitted = fit(reset, &some);
  ASSERT_EQ(fitted.objects.size(), 1U);
  const BakedObject &before = *reset.roots.front()->object, &after = *fitted.objects.begin()->second;
  std::size_t changed = 0;
  for (const ObservedTexel& texel : observed_texels(before, some)) {
    const TexelReader was(*before.sets[texel.set].texels), is(*after.sets[texel.set].texels);
    const int x = static_cast<int>(texel.x), y = static_cast<int>(texel.y);
    const bool differs = !(was.at(x, y) == is.at(x, y));
    changed += differs ? 1 : 0;
    EXPECT_TRUE(texel.chosen || !differs);
  }
  EXPECT_GT(changed, 100U);
}

// A photograph behind a wall, one of elsewhere, and invalid pixels show nothing.
TEST_F(PhotographFit, UnseenTexelsStay) {
  for (FitPhotograph& photograph : photographs_) photograph.valid.assign(side * side, 0);
  FitOfPhotographs fitted = fit(scene_);
  EXPECT_EQ(fitted.seen, 0U);
  EXPECT_GT(fitted.unseen, 1000U);
  EXPECT_TRUE(fitted.objects.empty());
  for (FitPhotograph& photograph : photographs_) {
    photograph.valid.assign(side * side, 1);
    photograph.camera.target = 2 * photograph.camera.eye;  // looks away
  }
  EXPECT_EQ(fit(scene_).seen, 0U);
  for (FitPhotograph& photograph : photographs_) {
    photograph.camera.target = Vec3(0, 0, 0);
    photograph.camera.eye *= 100;  // the object is a pixel
  }
  EXPECT_EQ(fit(scene_).seen, 0U);
  photographs_.clear();
  EXPECT_EQ(fit(scene_).seen, 0U);
}

}  // namespace
}  // namespace rebake::test
