// Light that follows edits: closed forms, known lights, and the identity if nothing changed.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "mesh_ops/deform/deform_object.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/light/estimate/light_estimate.h"
#include "mesh_ops/light/lighting.h"
#include "mesh_ops/light/transport/transfer.h"
#include "tests/support/lit_objects.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

using std::numbers::pi;

Radiance grey(double value) { return Radiance::Constant(value); }

Light uniform_light(double value) {
  Light light;
  light.sky = SkyMap(grey(value));
  return light;
}

LightSite site(const Vec3& position, const Vec3& normal) {
  return {position, normal.normalized(), normal.unitOrthogonal(), {1e-4, 1e-4}};
}

SceneRays rays_of_objects(const std::vector<std::shared_ptr<const BakedObject>>& objects) {
  std::vector<SceneRays::Instance> instances;
  for (const auto& object : objects)
    instances.push_back({rays_of(*object), Affine::Identity(), object->bounds().diagonal().norm()});
  return SceneRays(std::move(instances));
}

SiteLight traced(const LightSite& at, const SceneRays& around, const Light& light, int rays = 4096) {
  return traced_light(std::vector<LightSite>{at}, {}, around, light, Mat3::Identity(), {.rays = rays}).front();
}

Scene scene_with(std::vector<std::pair<std::string, std::shared_ptr<const BakedObject>>> objects, SceneLight light) {
  Scene scene;
  for (auto& [name, object] : objects) {
    Node node;
    node.name = name;
    node.object = object;
    scene = with_added(scene, std::move(node), NodeId::none, scene.roots.size());
  }
  scene.light = std::make_shared<const SceneLight>(light);
  return scene;
}

SceneLight given_uniform(double value) {
  SceneLight light;
  light.source = SceneLight::Source::uniform;
  light.zenith = grey(value);
  return light;
}

// Factor by which the map changes the linear grey level `color`, at the chart node nearest to `place` (object space).
Eigen::Vector3f factor_at(const BakedObject& object, const LightMap& map, const Vec3& place, float color = 0.4F) {
  const Soup& soup = object.sets.front().soup;
  double nearest = 1e300;
  Eigen::Vector3f gain = Eigen::Vector3f::Zero();
  for (const LightChart::Node& node : map.chart->nodes) {
    Vec3 p = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      p +=
          static_cast<double>(node.weights[k]) * soup.positions()[soup.faces()[node.face][static_cast<std::size_t>(k)]];
    if ((p - place).norm() >= nearest) continue;
    nearest = (p - place).norm();
    gain = map.gain[node.texel];
    if (!map.offset.empty()) gain += map.offset[node.texel] / color;
  }
  return gain;
}

const LightDecision* decision(const Lighting& lighting, const std::string& name) {
  for (const LightDecision& one : lighting.decisions)
    if (one.name == name) return &one;
  return nullptr;
}

TEST(SkyMap, ReproducesItsFunction) {
  const SkyMap map(32, [](const Vec3& d) -> Radiance { return {1 + d.x(), 2 + d.y(), 3 - d.z()}; });
  for (std::size_t k = 0; k < 32 * 32; ++k) {
    const Vec3 d = map.direction(k);
    EXPECT_NEAR(d.norm(), 1, 1e-12);
    EXPECT_LT((map.at(d) - Radiance(1 + d.x(), 2 + d.y(), 3 - d.z())).norm(), 1e-6);
  }
  EXPECT_LT((map.mean() - Radiance(1, 2, 3)).norm(), 2e-3);
  // Poles and seams of the octahedral map.
  for (const Vec3& d : {Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(1, 0, 0), Vec3(0, 0, -1), Vec3(0.6, -1e-12, 0.8)})
    EXPECT_LT((map.at(d) - Radiance(1 + d.x(), 2 + d.y(), 3 - d.z())).norm(), 0.1) << d.transpose();
}

TEST(DisplayColours, RoundTripThroughLinear) {
  for (const double value : {0.0, 1e-6, 0.0031308, 0.04045, 0.2, 0.5, 1.0, 3.0})
    EXPECT_NEAR(to_linear(to_display(value)), value, 1e-7 * std::max(1.0, value));
}

TEST(TracedLight, MatchesClosedFormsInTheOpenAndBesideAWall) {
  const auto away = lit_object({flat_quad({0, 50, 0}, {1, 0, 0}, {0, 0, 1})}, [](const Vec3&) { return grey(0.5); });
  const SiteLight open = traced(site({0, 0, 0}, {0, 1, 0}), rays_of_objects({away}), uniform_light(0.7));
  EXPECT_NEAR(open.irradiance[0][1], 0.7, 0.7 * 2e-4);
  EXPECT_NEAR(static_cast<double>(open.open[1]), 1, 1e-9);
  // An infinite wall of height h at distance d occludes ½ (1 − cos atan(h / d)) of a uniform sky.
  const auto wall =
      lit_object({flat_quad({1, -1, -400}, {0, 3, 0}, {0, 0, 800})}, [](const Vec3&) { return grey(0.5); });
  const SiteLight beside = traced(site({0, 0, 0}, {0, 1, 0}), rays_of_objects({wall}), uniform_light(1), 16384);
  EXPECT_NEAR(beside.irradiance[0][0], (1 + std::cos(std::atan(2.0))) / 2, 3e-3);
  // Occluders send the bounce radiance instead of the sky's.
  Light with_bounce = uniform_light(1);
  with_bounce.bounce = grey(0.25);
  const SiteLight bounced = traced(site({0, 0, 0}, {0, 1, 0}), rays_of_objects({wall}), with_bounce, 16384);
  EXPECT_NEAR(bounced.irradiance[0][0], beside.irradiance[0][0] + 0.25 * (1 - beside.irradiance[0][0]), 1e-6);
}

TEST(TracedLight, SunFollowsTheCosine) {
  Light light;
  for (const double degrees : {0.0, 30.0, 60.0, 85.0}) {
    const double a = degrees * pi / 180;
    light.suns = {{{std::sin(a), std::cos(a), 0}, 0.02, grey(2)}};
    EXPECT_NEAR(traced(site({0, 0, 0}, {0, 1, 0}), rays_of_objects({}), light).irradiance[0][2], 2 * std::cos(a), 2e-3);
  }
  // A sun behind the surface lights the other side.
  light.suns = {{{0, -1, 0}, 0.02, grey(2)}};
  const SiteLight behind = traced(site({0, 0, 0}, {0, 1, 0}), rays_of_objects({}), light);
  EXPECT_EQ(behind.irradiance[0], grey(0));
  EXPECT_NEAR(behind.irradiance[1][0], 2, 1e-3);
}

// Expected errors relative to 16384 rays: 4.2 % at 64 rays, 1.3 % at 256.
TEST(TracedLight, ErrorFallsWithMoreRays) {
  const auto object = lit_object(box_quads({-1, 0, -1}, {1, 1, 1}, 3), [](const Vec3&) { return grey(0.5); });
  const SceneRays rays = rays_of_objects({object});
  std::vector<LightSite> sites;
  for (int k = 0; k < 60; ++k) sites.push_back(site({-3 + 0.1 * k, 0, 1.4}, {0.2 * std::sin(k), 1, 0.1}));
  const auto at = [&](int count) {
    return traced_light(sites, {}, rays, uniform_light(1), Mat3::Identity(), {.rays = count});
  };
  const auto truth = at(16384);
  const auto error = [&](int count) {
    double off = 0, all = 0;
    const auto lit = at(count);
    for (std::size_t i = 0; i < sites.size(); ++i) {
      off += (lit[i].irradiance[0] - truth[i].irradiance[0]).squaredNorm();
      all += truth[i].irradiance[0].squaredNorm();
    }
    return std::sqrt(off / all);
  };
  EXPECT_LT(error(64), 0.04);
  EXPECT_LT(error(256), 0.013);
}

// If visibility past the object itself is cached (VisibilityFlags), only other occluders are traced. The light is the
// same to the bit.
TEST(TracedLight, CachedSelfShadowsGiveTheSameBits) {
  const auto own = lit_object(box_quads({-1, 0, -1}, {1, 1, 1}, 3), [](const Vec3&) { return grey(0.5); }),
             other = lit_object(box_quads({-3, 0, 2}, {3, 2, 2.5}, 2), [](const Vec3&) { return grey(0.5); });
  std::vector<LightSite> sites;
  for (int k = 0; k < 60; ++k) sites.push_back(site({-3 + 0.1 * k, 0, 1.4}, {0.2 * std::sin(k), 1, 0.1}));
  std::vector<std::uint8_t> wanted(sites.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = static_cast<std::uint8_t>(i % 4);
  Light light = uniform_light(0.7);
  light.suns = {{Vec3(-1, 1, -1).normalized(), 0.1, grey(2)}, {Vec3(0.2, 1, 0.5).normalized(), 0.05, grey(1)}};
  const auto lit = [&](const SceneRays& around, const IrradianceOptions& options) {
    return traced_light(sites, wanted, around, light, Mat3::Identity(), options);
  };
  const int rays = 50;
  VisibilityFlags open(sites.size(), rays, light.suns.size());
  const auto alone = lit(rays_of_objects({own}), {.rays = rays, .found = &open}),
             alone_again = lit(rays_of_objects({}), {.rays = rays, .known = &open}),
             both = lit(rays_of_objects({own, other}), {.rays = rays}),
             both_again = lit(rays_of_objects({other}), {.rays = rays, .known = &open});
  int darker = 0;
  for (std::size_t i = 0; i < sites.size(); ++i)
    for (std::size_t side = 0; side < 2; ++side) {
      EXPECT_EQ(alone_again[i].irradiance[side], alone[i].irradiance[side]) << i;
      EXPECT_EQ(both_again[i].irradiance[side], both[i].irradiance[side]) << i;
      EXPECT_EQ(both_again[i].open[side], both[i].open[side]) << i;
      darker += both[i].open[side] < alone[i].open[side] ? 1 : 0;
    }
  EXPECT_GT(darker, 20) << "the other object must occlude some sites";
}

// Unoccluded transfer is the clamped cosine. Its product with a sky's coefficients is the light traced under that sky.
TEST(TracedTransfer, MatchesCosineLobeAndTracedLight) {
  const LightSite tilted = site({0, 0, 0}, {0.3, 1, -0.2});
  const Transfer open = traced_transfer(std::vector<LightSite>{tilted}, rays_of_objects({}), 4096);
  EXPECT_LT((open.sites[0] - sh::clamped_cosine(tilted.normal)).norm(), 2e-3);
  const auto box = lit_object(box_quads({0.2, -1, -1}, {1, 1, 1}), [](const Vec3&) { return grey(0.5); });
  const SceneRays rays = rays_of_objects({box});
  // Sixteen coefficients represent a sky of degree 1 exactly.
  Light light;
  light.sky = SkyMap(64, [](const Vec3& d) { return grey(1 + 0.5 * d.x() - 0.3 * d.y()); });
  sh::Coefficients sky = sh::Coefficients::Zero();
  sky[0] = std::sqrt(4 * pi);
  sky[3] = 0.5 * std::sqrt(4 * pi / 3);
  sky[1] = -0.3 * std::sqrt(4 * pi / 3);
  const Transfer shaded = traced_transfer(std::vector<LightSite>{tilted}, rays, 16384);
  EXPECT_NEAR(shaded.sites[0].dot(sky), traced(tilted, rays, light).irradiance[0][0], 2e-3);
  // The transfer of a rigidly moved part rotates with it.
  const Mat3 turn = Eigen::AngleAxisd(0.8, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  LightSite turned = tilted;
  turned.normal = turn * tilted.normal;
  turned.tangent = turn * tilted.tangent;
  auto moved = std::make_shared<BakedObject>(*box);
  std::vector<Vec3> positions = box->sets.front().soup.positions();
  for (Vec3& p : positions) p = turn * p;
  moved->sets.front().soup = Soup(std::make_shared<const std::vector<Vec3>>(std::move(positions)),
                                  box->sets.front().soup.shared_uvs(), box->sets.front().soup.shared_faces());
  const Transfer traced_again = traced_transfer(std::vector<LightSite>{turned}, rays_of_objects({moved}), 16384);
  EXPECT_LT(relative_difference(rotated_transfer(shaded, std::vector<Mat3>{turn}).sites, traced_again.sites), 3e-3);
}

// Expected errors with one rotation of the rays per site, relative to 16384 rays: 4.2 % at 64 rays, 1.3 % at 256, 0.43
// % at 1024.
TEST(TracedTransfer, StatesItsError) {
  const auto object = lit_object(box_quads({-1, 0, -1}, {1, 1, 1}, 3), [](const Vec3&) { return grey(0.5); });
  const SceneRays rays = rays_of_objects({object});
  // Sites all around the box: errors of sites with similar views are correlated.
  std::vector<LightSite> sites;
  for (int k = 0; k < 60; ++k) {
    const Vec3 out(std::cos(0.105 * k), 0, std::sin(0.105 * k));
    sites.push_back(site((1.5 + 0.02 * k) * out, {0.2 * std::sin(k), 1, 0.2 * std::cos(2.0 * k)}));
  }
  const Transfer truth = traced_transfer(sites, rays, 16384);
  const double bars[] = {0.045, 0.014, 0.005};
  int count = 64;
  for (const double bar : bars) {
    const Transfer some = traced_transfer(sites, rays, count);
    const double error = relative_difference(some.sites, truth.sites);
    EXPECT_LT(error, bar) << count;
    EXPECT_GT(some.relative_error, 0.7 * error) << count;
    EXPECT_LT(some.relative_error, 3 * error) << count;
    count *= 4;
  }
}

TEST(LightChart, NodesAreUniqueAndVerticesLieInside) {
  const auto object = made_object({});
  const TextureSet& set = object->sets.front();
  const LightChart chart = light_chart(set, 4);
  std::set<std::uint32_t> texels;
  for (const LightChart::Node& node : chart.nodes) {
    EXPECT_TRUE(texels.insert(node.texel).second);
    EXPECT_NEAR(node.weights.sum(), 1, 1e-5);
    EXPECT_GE(node.weights.minCoeff(), -1e-6);
  }
  // Vertices lie between node centres of the chart, so interpolation within a face stays inside it.
  for (const Face& face : set.soup.faces())
    for (const std::uint32_t v : face) {
      const Eigen::Vector2f& place = chart.places[v];
      EXPECT_GE(place.x(), 0.5F - 1e-4F);
      EXPECT_LE(place.x(), static_cast<float>(chart.width) - 0.5F + 1e-4F);
      EXPECT_GE(place.y(), 0.5F - 1e-4F);
      EXPECT_LE(place.y(), static_cast<float>(chart.height) - 0.5F + 1e-4F);
    }
  EXPECT_GT(light_chart(set, 2).nodes.size(), 2 * chart.nodes.size());
}

TEST(Lighting, UneditedSceneHasNoCorrection) {
  const Lighting lighting = lighting_of(scene_with({{"ball", made_object({})}}, {}));
  EXPECT_TRUE(lighting.maps.empty());
  ASSERT_NE(decision(lighting, "self-shadow ball"), nullptr);
  EXPECT_FALSE(decision(lighting, "self-shadow ball")->runs);
  EXPECT_EQ(lighting.left_out, 0);
}

// Next to an infinite wall, both sides of a sheet keep half of their light on average.
TEST(Lighting, DarkensOccludedSurfaces) {
  const auto ground =
      lit_object({flat_quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 4, 4)}, [](const Vec3&) { return grey(0.4); });
  const auto wall =
      lit_object({flat_quad({1.01, -400, -400}, {0, 800, 0}, {0, 0, 800})}, [](const Vec3&) { return grey(0.4); });
  const Scene scene = scene_with({{"ground", ground}, {"wall", wall}}, given_uniform(1));
  const Lighting lighting = lighting_of(scene, {.rays = 1024});
  ASSERT_TRUE(decision(lighting, "cast shadow wall→ground")->runs);
  const auto& maps = lighting.maps.at(scene.roots.front()->id);
  ASSERT_NE(maps.front(), nullptr);
  EXPECT_NEAR(static_cast<double>(factor_at(*ground, *maps.front(), {0.9, 0, 0})[0]), 0.5, 0.02);
}

TEST(Lighting, RestoresLightBehindARemovedPart) {
  std::vector<LitQuad> quads{flat_quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 4, 4),
                             flat_quad({1.01, -1, -400}, {0, 401, 0}, {0, 0, 800})};
  const auto whole = lit_object(quads, [](const Vec3& p) { return p.x() > 1 ? grey(0.4) : grey(0.2); });
  Scene scene = scene_with({{"yard", whole}}, given_uniform(1));
  auto part = std::make_shared<BakedObject>(*whole);
  TriangleSet keep(whole->triangle_count(), 1);
  keep[keep.size() - 1] = keep[keep.size() - 2] = 0;
  part->sets.front().soup = subset(whole->sets.front().soup, keep, 0, true);
  record_bodies(*part, *whole);
  scene = with_changed(scene, scene.roots.front()->id, [&](Node& node) { node.object = part; });
  const Lighting lighting = lighting_of(scene, {.rays = 1024});
  ASSERT_TRUE(decision(lighting, "removed shadow yard")->runs);
  const auto& map = lighting.maps.at(scene.roots.front()->id).front();
  ASSERT_NE(map, nullptr);
  // Points that were baked in half of the light now get all of it.
  const double gain = static_cast<double>(factor_at(*part, *map, {0.9, 0, 0}, 0.2F)[0]);
  EXPECT_GT(gain, 1.6);
  EXPECT_LT(gain, 2.05);
  SceneLight without = given_uniform(1);
  without.removed = false;
  scene.light = std::make_shared<const SceneLight>(without);
  EXPECT_TRUE(lighting_of(scene).maps.empty());
}

TEST(Lighting, OmittedEffectsStayWithinBounds) {
  const auto ground =
      lit_object({flat_quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 2, 2)}, [](const Vec3&) { return grey(0.4); });
  const auto box = lit_object(box_quads({-0.5, 0, -0.5}, {0.5, 1, 0.5}), [](const Vec3&) { return grey(0.4); });
  double last = 1;
  for (const double away : {3.0, 10.0, 40.0, 160.0}) {
    Scene scene = scene_with({{"ground", ground}, {"box", box}}, given_uniform(1));
    const NodeId id = scene.roots[1]->id;
    scene = with_changed(scene, id, [&](Node& node) { node.to_parent.translation() = Vec3(away, 0, 0); });
    const Lighting planned = lighting_of(scene, {.rays = 1024});
    const Lighting everything = lighting_of(scene, {.rays = 1024, .everything = true});
    const LightDecision& cast = *decision(planned, "cast shadow box→ground");
    EXPECT_EQ(cast.runs, cast.change > scene.light->budget) << away;
    EXPECT_LE(planned.left_out, scene.light->budget);
    EXPECT_LE(cast.change, last);
    last = cast.change;
    // Largest true change by the effect, whether it ran or not.
    double change = 0;
    if (const auto found = everything.maps.find(scene.roots[0]->id);
        found != everything.maps.end() && found->second.front())
      for (const LightChart::Node& node : found->second.front()->chart->nodes) {
        const LightMap& map = *found->second.front();
        const double offset = map.offset.empty() ? 0 : static_cast<double>(map.offset[node.texel][0]);
        const double lit = 0.4 * static_cast<double>(map.gain[node.texel][0]) + offset;
        change = std::max(change, std::abs(to_display(lit) - to_display(0.4)));
      }
    EXPECT_LE(change, cast.change) << away;
  }
  EXPECT_LT(last, 1.0 / 255);
}

// Occluders may be brighter than the sky (bounce). With one light shared by all objects, bounds are those of that
// light.
TEST(Lighting, BoundsCountBounceAndTheSharedLight) {
  const auto ground =
      lit_object({flat_quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 2, 2)}, [](const Vec3&) { return grey(0.4); });
  const auto box = lit_object(box_quads({1.2, 0, -0.5}, {1.7, 1, 0.5}), [](const Vec3&) { return grey(0.4); });
  SceneLight light = given_uniform(0);
  light.bounce = grey(1);
  EXPECT_TRUE(
      decision(lighting_of(scene_with({{"ground", ground}, {"box", box}}, light)), "cast shadow box→ground")->runs);
  light = {};
  light.source = SceneLight::Source::sky;
  light.match = true;
  light.sun.direction = {1, 0.2, 0};
  Scene scene = scene_with({{"ground", ground}, {"box", box}}, light);
  // Rotating the ground would rotate its own light; the shared sun stays behind the box.
  scene = with_changed(scene, scene.roots[0]->id, [](Node& node) {
    node.to_parent.linear() = Eigen::AngleAxisd(pi / 2, Vec3::UnitY()).toRotationMatrix();
  });
  const Lighting lighting = lighting_of(scene);
  EXPECT_GT(decision(lighting, "cast shadow box→ground")->change, 0.9);
}

// A bend by 0° leaves colours unchanged; mirrored and scaled objects get the same light.
TEST(Lighting, FoldedScaledMirroredAndShearedObjects) {
  const auto hinge = lit_object(
      {flat_quad({0, 0, -1}, {0, 0, 2}, {1, 0, 0}, 4, 4), flat_quad({-1, 0, -1}, {0, 0, 2}, {1, 0, 0}, 4, 4)},
      [](const Vec3&) { return grey(0.4); });
  const auto folded_by = [&](double degrees, double scale) {
    auto sized = std::make_shared<BakedObject>(*hinge);
    const Soup& soup = hinge->sets.front().soup;
    std::vector<Vec3> positions = soup.positions();
    for (Vec3& p : positions) p *= scale;
    sized->sets.front().soup =
        Soup(std::make_shared<const std::vector<Vec3>>(positions), soup.shared_uvs(), soup.shared_faces());
    TriangleSet flags(hinge->triangle_count(), 0);
    for (std::size_t f = flags.size() / 2; f < flags.size(); ++f) flags[f] = 1;
    const Mat3 turn = Eigen::AngleAxisd(-degrees * pi / 180, Vec3::UnitZ()).toRotationMatrix();
    const auto made = deformed(*sized, Affine::Identity(), flags, 0, [&](const std::vector<Vec3>& points) {
      DeformedPoints out;
      for (const Vec3& p : points) out.points.push_back(turn * p);
      out.jacobians.assign(points.size(), turn);
      out.outside.assign(points.size(), 0);
      return out;
    });
    return made.object;
  };
  const auto gain_of = [&](const std::shared_ptr<const BakedObject>& object, const Affine& placed, const Vec3& at) {
    Scene scene = scene_with({{"hinge", object}}, given_uniform(1));
    scene = with_changed(scene, scene.roots.front()->id, [&](Node& node) { node.to_parent = placed; });
    const Lighting lighting = lighting_of(scene, {.rays = 256});
    const auto found = lighting.maps.find(scene.roots.front()->id);
    if (found == lighting.maps.end() || !found->second.front()) return Eigen::Vector3f(1, 1, 1);
    for (const Eigen::Vector3f& gain : found->second.front()->gain) EXPECT_TRUE(gain.allFinite());
    return factor_at(*object, *found->second.front(), at);
  };
  // Folded upright at distance 0.2, the other half occludes ½ (1 − cos atan(1 / 0.2)) of the sky above, and nothing
  // below.
  const double one = static_cast<double>(gain_of(folded_by(90, 1), Affine::Identity(), {0.2, 0, 0})[0]);
  EXPECT_NEAR(one, (1 + (1 + std::cos(std::atan(5.0))) / 2) / 2, 0.02);
  EXPECT_EQ(gain_of(folded_by(0, 1), Affine::Identity(), {0.2, 0, 0}), Eigen::Vector3f(1, 1, 1));
  for (const double scale : {1e-6, 1e6})
    EXPECT_NEAR(static_cast<double>(gain_of(folded_by(90, scale), Affine::Identity(), {0.2 * scale, 0, 0})[0]), one,
                0.02);
  Affine mirrored = Affine::Identity();
  mirrored.linear() = Vec3(-1, 1, 1).asDiagonal();
  EXPECT_NEAR(static_cast<double>(gain_of(folded_by(90, 1), mirrored, {0.2, 0, 0})[0]), one, 1e-6);
  Affine sheared = Affine::Identity();
  sheared.linear()(0, 1) = 1e-6;
  EXPECT_NEAR(static_cast<double>(gain_of(folded_by(90, 1), sheared, {0.2, 0, 0})[0]), one, 0.03);
  // Folded onto itself and beyond: gains must stay finite.
  for (const double degrees : {179.9999, 180.0, 181.0}) gain_of(folded_by(degrees, 1), Affine::Identity(), {0.2, 0, 0});
}

// Colours do not tell a blue light from a blue object. So a matched object takes the directional distribution of the
// reference object's light, and keeps its own brightness and tint.
TEST(Lighting, MatchingKeepsTintAndTakesDirection) {
  // Boxes in ambient light 0.4, with 0.6 more on the sides that face +x.
  const auto box_of = [](const Radiance& albedo) {
    return lit_object(box_quads({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, 2),
                      [&](const Vec3& at) -> Radiance { return albedo * (at.x() > 0.499 ? 1.0 : 0.4); });
  };
  const auto green = box_of({0.1, 0.6, 0.2}), blue = box_of({0.05, 0.2, 0.7});
  SceneLight light;
  light.match = true;
  light.cast = false;
  Scene scene = scene_with({{"green", green}, {"blue", blue}}, light);
  scene = with_changed(scene, scene.roots[1]->id, [](Node& node) {
    node.to_parent.linear() = Eigen::AngleAxisd(pi, Vec3::UnitY()).toRotationMatrix();
    node.to_parent.translation() = Vec3(3, 0, 0);
  });
  const Lighting lighting = lighting_of(scene);
  EXPECT_FALSE(lighting.maps.contains(scene.roots[0]->id)) << "the first object is the reference";
  ASSERT_TRUE(lighting.maps.contains(scene.roots[1]->id));
  const LightMap& map = *lighting.maps.at(scene.roots[1]->id).front();
  for (int c = 0; c < 3; ++c) {
    const auto gain = [&](const Vec3& at, double shown) {
      return static_cast<double>(factor_at(*blue, map, at, static_cast<float>(shown))[c]);
    };
    const double albedo = std::array{0.05, 0.2, 0.7}[static_cast<std::size_t>(c)];
    EXPECT_NEAR(gain({-0.5, 0.2, 0.2}, 0.4 * albedo), 2.5, 0.4) << "the side that faces the light now";
    EXPECT_NEAR(gain({0.5, 0.2, 0.2}, albedo), 0.4, 0.08) << "the side that was lit as baked";
    EXPECT_NEAR(gain({0.2, 0.5, 0.2}, 0.4 * albedo), 1, 0.15) << "its top";
  }
  EXPECT_NE(decision(lighting, "matched light blue")->why.find("distribution of light from green"), std::string::npos);
}

// If no light can be estimated from the first object, the others keep their own light.
TEST(Lighting, DoesNotMatchAnUnknownLight) {
  const auto line = lit_object({flat_quad({-1, 0, 0}, {2, 0, 0}, {1, 0, 0})}, [](const Vec3&) { return grey(0.4); });
  const auto box = lit_object(box_quads({2, 0, 0}, {3, 1, 1}), [](const Vec3&) { return grey(0.4); });
  SceneLight light;
  light.match = true;
  light.cast = false;
  const Lighting lighting = lighting_of(scene_with({{"line", line}, {"box", box}}, light));
  EXPECT_TRUE(lighting.maps.empty());
  const LightDecision* left_out = decision(lighting, "matched light box");
  ASSERT_NE(left_out, nullptr);
  EXPECT_FALSE(left_out->runs);
  EXPECT_EQ(left_out->why, "could not estimate light in all three channels from the colours of line");
}

TEST(Lighting, DarknessChangesNothing) {
  const auto ground = lit_object({flat_quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0})}, [](const Vec3&) { return grey(0.4); });
  const auto box = lit_object(box_quads({-0.5, 0.1, -0.5}, {0.5, 1, 0.5}), [](const Vec3&) { return grey(0.4); });
  const Lighting lighting =
      lighting_of(scene_with({{"ground", ground}, {"box", box}}, given_uniform(0)), {.everything = true});
  for (const auto& [node, maps] : lighting.maps)
    for (const auto& map : maps) EXPECT_EQ(map, nullptr);
}

}  // namespace
}  // namespace rebake::test
