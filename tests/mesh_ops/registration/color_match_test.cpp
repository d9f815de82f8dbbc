// Colours of captures are matched where both have the same surfaces.
#include "mesh_ops/registration/color_match.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/scene_files.h"
#include "mesh_ops/scene/scene_light.h"
#include "mesh_ops/texture/decoder.h"
#include "tests/support/made_scenes.h"
#include "tests/support/nerf2mesh_example.h"
#include "tests/support/script_fixture.h"

namespace rebake::test {
namespace {

constexpr ColorChange warm{{1.2, 1.1, 0.9}, {0.5, 0.1, -0.3}};

ColorChange inverse(const ColorChange& change) {
  ColorChange back;
  for (std::size_t c = 0; c < 3; ++c) {
    back.gain[c] = 1 / change.gain[c];
    back.offset[c] = -change.offset[c] / change.gain[c];
  }
  return back;
}

std::vector<PlacedNode> placed(const std::shared_ptr<const BakedObject>& object, const Affine& to_world) {
  Scene scene = scene_of(object);
  return placed_nodes(with_changed(scene, scene.roots[0]->id, [&](Node& node) { node.to_parent = to_world; }));
}

// Smooth textures: a texel and its neighbours have nearly the same colour.
std::shared_ptr<const BakedObject> smooth_object(unsigned seed, AlphaCode code = AlphaCode::halved) {
  return made_object({.columns = 12, .rows = 6, .cell = 33, .seed = seed, .code = code, .holes = false});
}

void expect_near(const ColorChange& found, const ColorChange& truth, double gain, double offset) {
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(found.gain[c], truth.gain[c], gain) << c;
    EXPECT_NEAR(found.offset[c], truth.offset[c], offset) << c;
  }
}

TEST(ColorMatch, DecodersChangeExactly) {
  const auto object = made_object();
  const auto changed = recolored(*object, warm);
  const std::array<double, 8> features{1, 0.2, 0.7, 0.4, 0.9, 0.1, 0.5, 0.3};
  const Vec3 direction = Vec3(1, -2, 0.5).normalized();
  const Color expected = warm(decode(*object->decoder, features, direction));
  EXPECT_LE((decode(*changed->decoder, features, direction) - expected).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(changed->sets[0].texels, object->sets[0].texels) << "textures are shared";
}

TEST(ColorMatch, FindsTheChangeAnywhere) {
  for (const double away : {0.0, 1e6}) {
    const Affine place = Eigen::Translation3d(away, 0, -away) * Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()) *
                         Eigen::UniformScaling<double>(away > 0 ? 1e-2 : 1);
    const auto truth = smooth_object(3);
    const ColorMatch match = matched_colors(placed(recolored(*truth, inverse(warm)), place), placed(truth, place), {});
    EXPECT_GT(match.pairs, 15'000U);
    EXPECT_GT(match.before, 0.05);
    EXPECT_LT(match.after, 0.012);
    expect_near(match.change, warm, 0.02, 0.03);
  }
}

TEST(ColorMatch, RejectsOutliers) {
  const auto truth = smooth_object(3);
  // A tenth of the texels shows something else.
  auto damaged = std::make_shared<BakedObject>(*recolored(*truth, inverse(warm)));
  for (TextureSet& set : damaged->sets) {
    FeatureTexture::Change change(*set.texels);
    for (int y = 0; y < set.texels->height(); ++y)
      for (int x = 0; x < set.texels->width(); ++x)
        if (set.texels->opaque(x, y) && (x / 33 + 3 * (y / 33)) % 10 == 0)
          change.at(x, y) = {{255, 255, 0, 255}, {0, 255, 0, 255}};
    set.texels = change.finish();
  }
  const ColorMatch match = matched_colors(placed(damaged, Affine::Identity()), placed(truth, Affine::Identity()), {});
  expect_near(match.change, warm, 0.05, 0.06);
  EXPECT_LT(match.used, 0.99);
}

// Exposure in linear light is not a change of logits, but close to one.
TEST(ColorMatch, ExposureIsNearlyAChangeOfLogits) {
  // With colours over the whole range.
  auto bright = std::make_shared<BakedObject>(*smooth_object(5, AlphaCode::plain));
  bright->decoder = std::make_shared<const Decoder>(diffuse_decoder());
  const auto exposed = [&](const BakedObject& object, double exposure) {
    auto made = std::make_shared<BakedObject>(object);
    for (TextureSet& set : made->sets) {
      FeatureTexture::Change change(*set.texels);
      for (int y = 0; y < set.texels->height(); ++y)
        for (int x = 0; x < set.texels->width(); ++x) {
          Texel& texel = change.at(x, y);
          if (texel.opaque()) texel.feat0[0] = 255;
          for (std::size_t c = 1; c < 4; ++c)
            texel.feat0[c] =
                static_cast<std::uint8_t>(std::lround(255 * to_display(exposure * to_linear(texel.feat0[c] / 255.0))));
        }
      set.texels = change.finish();
    }
    return made;
  };
  const auto fixed = exposed(*bright, 1);
  for (const auto& [exposure, remains] : {std::pair(0.5, 0.055), {0.8, 0.022}}) {
    const auto dark = exposed(*bright, exposure);
    const ColorMatch match = matched_colors(placed(dark, Affine::Identity()), placed(fixed, Affine::Identity()), {});
    EXPECT_GT(match.before, 3 * match.after) << exposure;
    EXPECT_LT(match.after, remains) << exposure;
    const auto matched = recolored(*dark, match.change);
    const ColorMatch again = matched_colors(placed(matched, Affine::Identity()), placed(fixed, Affine::Identity()), {});
    EXPECT_NEAR(again.before, match.after, 0.004) << "texels hold the changed colours";
  }
}

TEST(ColorMatch, NoisyColoursKeepTheirContrast) {
  const auto truth = smooth_object(3);
  const auto noisy = [&](unsigned seed) {
    auto made = std::make_shared<BakedObject>(*truth);
    std::mt19937 random(seed);
    for (TextureSet& set : made->sets) {
      FeatureTexture::Change change(*set.texels);
      for (int y = 0; y < set.texels->height(); ++y)
        for (int x = 0; x < set.texels->width(); ++x)
          if (set.texels->opaque(x, y))
            for (std::uint8_t& byte : change.at(x, y).feat1)
              byte = static_cast<std::uint8_t>(
                  std::clamp(static_cast<int>(byte) + static_cast<int>(random() % 61) - 30, 0, 255));
      set.texels = change.finish();
    }
    return made;
  };
  const ColorMatch match =
      matched_colors(placed(noisy(1), Affine::Identity()), placed(noisy(2), Affine::Identity()), {});
  expect_near(match.change, {}, 0.03, 0.04);
}

TEST(ColorMatch, RefusesWhatItCannotMatch) {
  const auto object = smooth_object(3);
  EXPECT_THROW(
      matched_colors(placed(object, Affine::Identity()), placed(object, Affine(Eigen::Translation3d(9, 0, 0))), {}),
      Error);
  const TemporaryFolder folder;
  write_nerf2mesh_example(folder.path() / "n");
  EXPECT_THROW(recolored(*read_any(folder.path() / "n", Axes::y_up).roots[0]->object, warm), EditError);
}

TEST_F(Script, MatchColorsChangesOneCapture) {
  std::string said;
  session.report = [&](const std::string& line) { said += line; };
  run(import + R"({"op": "duplicate", "node": "ball", "as": "other"}
{"op": "match_colors", "node": "ball", "to": "other"})");
  EXPECT_NE(said.find("common points"), std::string::npos) << said;
  expect_error(R"({"op": "match_colors", "node": "ball", "to": "ball"})", "is the node itself");
  expect_error(R"({"op": "match_colors", "node": "ball", "distance": 0})", "distance");
}

}  // namespace
}  // namespace rebake::test
