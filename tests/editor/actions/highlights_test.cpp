// Highlights of rotated surfaces reflect the light where it is, not as it was baked.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "editor/actions/plain_scene.h"
#include "mesh_ops/light/lighting.h"
#include "render/graph/effects.h"
#include "render/picture.h"
#include "tests/support/edits.h"
#include "tests/support/lit_objects.h"
#include "tests/support/lit_scenes.h"

namespace rebake::test {
namespace {

using nlohmann::json;

const Vec3 sun = Vec3(0.3, 1, 0.2).normalized();

// A grey plate that faces up, with a decoder that shows the specular highlight of the sun. One hidden unit is linear in
// the view direction, as is reflection by a plane, so it can represent the highlight.
const std::vector<LitQuad> one_patch{flat_quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 4, 4)};
Scene unlit_plate(double highlight, const std::vector<LitQuad>& quads = one_patch) {
  auto object = std::make_shared<BakedObject>(*lit_object(quads, [](const Vec3&) { return Radiance(0.2, 0.2, 0.2); }));
  object->axes = Axes::forward;
  Decoder d = *object->decoder;
  const Eigen::Index unit = d.weights0.cols();
  d.weights0.conservativeResize(Eigen::NoChange, unit + 1);
  d.weights0.col(unit).setZero();
  constexpr double steep = 10;
  d.weights0.col(unit).tail<3>() = steep * Vec3(sun.x(), -sun.y(), sun.z());
  d.bias0.conservativeResize(unit + 1);
  d.bias0[unit] = -0.9 * steep;
  d.weights1.conservativeResize(unit + 1, unit + 1);
  d.weights1.col(unit).setZero();
  d.weights1.row(unit).setZero();
  d.weights1(unit, unit) = 1;
  d.bias1.conservativeResize(unit + 1);
  d.bias1[unit] = 0;
  d.weights2.conservativeResize(unit + 1, Eigen::NoChange);
  d.weights2.row(unit).setConstant(highlight);
  object->decoder = std::make_shared<const Decoder>(d);
  Node node;
  node.name = "plate";
  node.object = object;
  return with_added({}, std::move(node), NodeId::none, 0);
}
Scene in_sun(const Scene& scene) {
  return apply(scene, read_edit({{"op", "light"}, {"source", "sky"}, {"sun", {sun.x(), sun.y(), sun.z()}}}, scene))
      .scene;
}
Scene plate(double highlight) { return in_sun(unlit_plate(highlight)); }

Scene tilted(Scene scene, double degrees) {
  for (const json& line : std::vector<json>{{{"op", "select"}, {"box", {{"min", {-9, -9, -9}}, {"max", {9, 9, 9}}}}},
                                            {{"op", "transform"},
                                             {"node", "plate"},
                                             {"selection", true},
                                             {"rotate", {{"axis", {1, 0, 0}}, {"degrees", degrees}}},
                                             {"pivot", {0, 0, 0}}}})
    scene = apply(scene, read_edit(line, scene)).scene;
  return scene;
}

// A view of the plate's centre along `direction`.
View looking(const Vec3& direction) {
  View view;
  view.camera.eye = -3 * direction;
  view.camera.target = {0, 0, 0};
  view.camera.up = std::abs(direction.y()) > 0.9 ? Vec3(0, 0, 1) : Vec3(0, 1, 0);
  view.camera.near_plane = 0.1;
  view.camera.far_plane = 10;
  view.width = view.height = 65;
  return view;
}

int middle(const Image& image) { return image.rgb[(32 * 65 + 32) * 3]; }

TEST(Highlights, StayWithTheLightOfARotatedSurface) {
  const double degrees = 45, radians = degrees * std::numbers::pi / 180;
  const Scene scene = tilted(plate(6), degrees);
  const Lighting lighting = lighting_of(scene);
  ASSERT_TRUE(runs(lighting, "highlights plate")) << decision_named(lighting, "highlights plate")->why;
  const TextureSet& set = scene.roots.front()->object->sets.front();
  const auto map = lighting.map_of(scene.roots.front()->id, 0, set);
  ASSERT_TRUE(map && map->gloss);
  const Mat3 turn = Eigen::AngleAxisd(radians, Vec3::UnitX()).toRotationMatrix();
  const auto mirror = [](const Vec3& d, const Vec3& n) -> Vec3 { return d - 2 * n.dot(d) * n; };
  const Vec3 up(0, 1, 0), now = turn * up;
  // View directions that see the highlight: of the sun, and of a sun that had rotated with the plate.
  const Vec3 to_sun = mirror(sun, now), as_baked = turn * mirror(sun, up);
  Renderer renderer;
  for (const int samples : {1, 4}) {
    for (const Vec3& direction : {to_sun, as_baked, Vec3(-now)}) {
      View view = looking(direction);
      view.samples = samples;
      const int plain = middle(renderer.render(scene, view)), lit = middle(renderer.render(scene, view, {}, &lighting));
      // Expected colour, by the library's gloss_change() at the same point.
      const Eigen::Vector2f place(map->chart->places.front() + map->chart->places.back());
      const GlossPlace at = interpolated(*map->chart, *map->gloss, Eigen::Vector2f(place / 2));
      const double gain = static_cast<double>(interpolated(*map->chart, map->gain, Eigen::Vector2f(place / 2))[0]);
      const double offset =
          map->offset.empty()
              ? 0
              : static_cast<double>(interpolated(*map->chart, map->offset, Eigen::Vector2f(place / 2))[0]);
      const Radiance change =
          gloss_change(*map->gloss->gloss, at, Radiance::Constant(gain), turn.transpose() * direction, direction);
      const double expected =
          255 * to_display(std::clamp(gain * to_linear(plain / 255.0) + offset + change[0], 0.0, 1.0));
      EXPECT_NEAR(lit, expected, 2) << samples;
      if (direction == to_sun) {
        EXPECT_GT(lit, plain + 20);
      }
      if (direction == as_baked) {
        EXPECT_LT(lit, plain - 20);
      }
    }
  }
  EXPECT_TRUE(plan(scene, looking(to_sun), {}, nullptr, &lighting).runs(effects::highlights));
}

// View direction that sees the sun in a plate that is tilted about x by `degrees`.
Vec3 towards_highlight(double degrees) {
  const Vec3 now(0, std::cos(degrees * std::numbers::pi / 180), std::sin(degrees * std::numbers::pi / 180));
  return sun - 2 * now.dot(sun) * now;
}

TEST(Highlights, MirroredNodeMatchesMirroredScene) {
  // Mirroring at a plane that contains the sun and the axis of the tilt, which reverses the tilt.
  const Vec3 across = Vec3::UnitX().cross(sun).normalized();
  const Mat3 mirror = Mat3::Identity() - 2 * across * across.transpose();
  Scene mirrored_plate = unlit_plate(6);
  mirrored_plate = with_changed(mirrored_plate, mirrored_plate.roots.front()->id,
                                [&](Node& node) { node.to_parent.linear() = mirror; });
  const Scene scene = tilted(plate(6), 45), other = tilted(in_sun(mirrored_plate), -45);
  const Lighting lighting = lighting_of(scene), other_lighting = lighting_of(other);
  ASSERT_TRUE(runs(other_lighting, "highlights plate")) << decision_named(other_lighting, "highlights plate")->why;
  Renderer renderer;
  for (const Vec3& direction : {towards_highlight(45), Vec3(Vec3(0.1, -0.8, -0.5).normalized())}) {
    const View view = looking(direction), other_view = looking(mirror * direction);
    EXPECT_NEAR(middle(renderer.render(other, other_view, {}, &other_lighting)),
                middle(renderer.render(scene, view, {}, &lighting)), 3);
    EXPECT_NEAR(middle(renderer.render(other, other_view)), middle(renderer.render(scene, view)), 1);
  }
}

TEST(Highlights, SeveralPatchesMatchOne) {
  // The second patch has the opposite normal: both sides of a surface reflect.
  const std::vector<LitQuad> two{flat_quad({-1, 0, -1}, {0, 0, 2}, {0.9, 0, 0}, 4, 2),
                                 flat_quad({-0.1, 0, -1}, {1.1, 0, 0}, {0, 0, 2}, 2, 4)};
  const Scene scene = tilted(plate(6), 45), other = tilted(in_sun(unlit_plate(6, two)), 45);
  const Lighting lighting = lighting_of(scene), other_lighting = lighting_of(other);
  ASSERT_TRUE(runs(other_lighting, "highlights plate")) << decision_named(other_lighting, "highlights plate")->why;
  Renderer renderer;
  const View view = looking(towards_highlight(45));
  const Image as_one = renderer.render(scene, view, {}, &lighting),
              as_two = renderer.render(other, view, {}, &other_lighting);
  // A pixel on the left patch and one on the right patch.
  for (const std::size_t x : {26U, 40U}) {
    const std::size_t at = (32 * 65 + x) * 3;
    EXPECT_NEAR(as_two.rgb[at], as_one.rgb[at], 3) << x;
    EXPECT_GT(as_two.rgb[at], middle(renderer.render(other, view)) + 15) << x;
  }
}

TEST(Highlights, PlainFoldersContainHighlights) {
  const Scene scene = tilted(plate(6), 45);
  const Lighting lighting = lighting_of(scene);
  FuseOptions options;
  options.sample = 1024;
  options.training.steps = 600;
  PlainReport report;
  const Scene plain = plain_scene(scene, lighting, options, report, {});
  Renderer renderer;
  const View view = looking(towards_highlight(45));
  const int lit = middle(renderer.render(scene, view, {}, &lighting)), unlit = middle(renderer.render(scene, view)),
            baked = middle(renderer.render(plain, view));
  ASSERT_GT(lit, unlit + 20);
  EXPECT_GT(baked, unlit + 0.8 * (lit - unlit))
      << "most of the added light must be in the folder: " << unlit << " to " << lit;
}

TEST(Highlights, OmittedForMatteSurfaces) {
  const Scene scene = tilted(plate(0), 30);
  const Lighting lighting = lighting_of(scene);
  const LightDecision* decision = decision_named(lighting, "highlights plate");
  ASSERT_NE(decision, nullptr);
  EXPECT_FALSE(decision->runs);
  EXPECT_NE(decision->why.find("its colours do not depend on the view direction"), std::string::npos);
  EXPECT_TRUE(runs(lighting, "self-shadow plate"));
  EXPECT_FALSE(plan(scene, looking({0, -1, 0}), {}, nullptr, &lighting).runs(effects::highlights));
}

TEST(Highlights, OmittedIfNotRequested) {
  Scene scene = tilted(plate(6), 30);
  scene = apply(scene, read_edit({{"op", "light"}, {"source", "sky"}, {"effects", {"self"}}}, scene)).scene;
  const Lighting lighting = lighting_of(scene);
  ASSERT_NE(decision_named(lighting, "highlights plate"), nullptr);
  EXPECT_EQ(decision_named(lighting, "highlights plate")->why, "disabled in the light settings");
  // Without a rotation there is no decision about highlights.
  EXPECT_EQ(decision_named(lighting_of(plate(6)), "highlights plate"), nullptr);
}

TEST(Gloss, ReflectsSkyAndSunsByFresnel) {
  Gloss gloss;
  for (sh::Coefficients& channel : gloss.sky) channel[0] = 2 / sh::basis({0, 0, 1})[0];
  gloss.suns = {{Vec3(0, 0, 1), 0.01, Radiance(3, 2, 1)}};
  gloss.sharpness = 10;
  const Vec3 down(0, 0, -1), up(0, 0, 1);
  // A dielectric of index 1.5 reflects 4 % at normal incidence and everything at grazing angles.
  EXPECT_LT((mirrored(gloss, down, up, 1, 0) - Radiance::Constant(0.08)).norm(), 1e-12);
  EXPECT_LT((mirrored(gloss, {1, 0, 0}, up, 1, 0) - Radiance::Constant(2)).norm(), 1e-12);
  EXPECT_LT((mirrored(gloss, down, up, 0, 1) - 0.04 * Radiance(3, 2, 1)).norm(), 1e-12);
  // Both sides of a surface reflect alike, and rotating everything changes nothing.
  const Vec3 d = Vec3(0.3, -0.2, -0.8).normalized(), n = Vec3(0.1, 0.5, 0.9).normalized();
  EXPECT_EQ(mirrored(gloss, d, n, 1, 1), mirrored(gloss, d, -n, 1, 1));
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  Gloss turned = gloss;
  turned.suns[0].direction = turn * up;
  EXPECT_LT((mirrored(turned, turn * d, turn * n, 1, 1) - mirrored(gloss, d, n, 1, 1)).norm(), 1e-12);
  // Without a rotation nothing changes.
  GlossPlace place;
  place.before << n.cast<float>(), 0.7F;
  place.after = place.before;
  place.suns_before = place.suns_after = 0.3F;
  EXPECT_EQ(gloss_change(gloss, place, Radiance::Ones(), d, d), Radiance::Zero());
}

}  // namespace
}  // namespace rebake::test
