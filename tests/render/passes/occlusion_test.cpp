// Occlusion culling must not change a byte of any picture, whatever was drawn before. It must cull hidden triangles,
// and must not run if it does not pay.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mesh_ops/formats/formats.h"
#include "render/graph/effects.h"
#include "render/picture.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

using Occlusion = RenderOptions::Occlusion;

// Two renderers: one draws everything, the other culls and remembers its last frame.
struct Pair {
  Renderer all, some;

  void expect_same(const Scene& scene, const View& view, const std::string& what, RenderOptions options = {}) {
    options.occlusion = Occlusion::off;
    const Image expected = all.render(scene, view, options);
    options.occlusion = Occlusion::on;
    const Image drawn = some.render(scene, view, options);
    EXPECT_TRUE(expected.rgb == drawn.rgb) << what;
  }
  // With the camera at rest: visibility is tested per sample in the third frame, and not at all in the fourth.
  void expect_same_at_rest(const Scene& scene, const View& view, const std::string& what, RenderOptions options = {}) {
    for (int frame = 0; frame < 4; ++frame) expect_same(scene, view, fmt::format("{}, frame {}", what, frame), options);
  }

  // The statement about occlusion culling in the plan of the last picture.
  std::string said() const {
    for (const PlannedPass& pass : some.passes())
      if (pass.effect == &effects::occlusion) return pass.why;
    return "";
  }
};

Pair& renderers() {
  static Pair pair;
  return pair;
}

View view_of(const Vec3& eye, const Vec3& target, int samples = 4) {
  View view;
  view.camera.eye = eye;
  view.camera.target = target;
  view.camera.near_plane = 0.05;
  view.camera.far_plane = 50;
  view.width = 200;
  view.height = 150;
  view.samples = samples;
  return view;
}

// Intersecting and stretched spheres, two equal ones at the same place, one with a rotated part, one far away.
Scene crowd() {
  Scene scene;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1.2, 1.2), angle(0, 3);
  const auto dense = made_object({.columns = 64, .rows = 32, .cell = 9});
  const auto other = made_object({.columns = 48, .rows = 24, .cell = 9, .seed = 2, .radius = 0.4});
  const auto add = [&](std::shared_ptr<const BakedObject> object, const Affine& to_world) {
    Node node;
    node.object = std::move(object);
    node.to_parent = to_world;
    scene = with_added(scene, node, NodeId::none, 99);
  };
  add(dense, Affine::Identity());
  add(dense, Affine::Identity());  // equal depths everywhere: the later one is visible
  for (int k = 0; k < 6; ++k)
    add(other, Eigen::Translation3d(place(random), place(random), place(random)) *
                   Eigen::AngleAxisd(angle(random), Vec3::UnitY()) * Eigen::Scaling(1.0, 0.5 + 0.2 * k, 1.0));
  auto parted = std::make_shared<BakedObject>(*other);
  TriangleSet half(parted->triangle_count(), 0);
  std::fill(half.begin(), half.begin() + static_cast<std::ptrdiff_t>(half.size() / 2), 1);
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3::UnitZ()).toRotationMatrix();
  parted->sets[0].soup = move_faces(parted->sets[0].soup, half, 0, Affine(turn), turn);
  add(parted, Affine(Eigen::Translation3d(0.8, 0.8, 0.2)));
  add(other, Affine(Eigen::Translation3d(0, 0, -30)));
  return scene;
}

class OcclusionBySamples : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Occlusion, OcclusionBySamples, ::testing::Values(1, 4, 16));

TEST_P(OcclusionBySamples, ChangesNoByteForMovingCameras) {
  const Scene scene = crowd();
  for (int k = 0; k < 8; ++k) {
    const double turn = 0.05 * k;
    const View view = view_of({3 * std::sin(turn), 1, 3 * std::cos(turn)}, {0, 0, 0}, GetParam());
    if (k == 5)
      renderers().expect_same_at_rest(scene, view, "at rest");
    else
      renderers().expect_same(scene, view, fmt::format("turning, {}", k));
  }
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-2, 2);
  for (int k = 0; k < 12; ++k)
    renderers().expect_same(scene,
                            view_of({place(random), place(random), place(random)},
                                    {place(random), place(random), place(random)}, GetParam()),
                            fmt::format("jump {}", k));
  for (const double distance : {1.3, 1.05, 1.001, 0.97, 0.5, 0.0001})
    renderers().expect_same_at_rest(scene, view_of({0, 0, distance}, {0, 0.01, -1}, GetParam()),
                                    fmt::format("eye at {}", distance));
}

TEST_P(OcclusionBySamples, ChangesNoByteInOrthographicViews) {
  View view = view_of({2, 1, 3}, {0, 0, 0}, GetParam());
  for (const double height : {4.0, 0.3, 100.0}) {
    view.camera.ortho_height = height;
    renderers().expect_same_at_rest(crowd(), view, fmt::format("height {}", height));
  }
}

TEST(Occlusion, ChangesNoByteFarFromTheOriginTinyAndHuge) {
  for (const double scale : {1e-3, 1.0, 1e3})
    for (const double away : {0.0, 1e3, 1e6}) {
      Scene scene = crowd();
      for (const NodePtr& node : std::vector<NodePtr>(scene.roots))
        scene = with_changed(scene, node->id, [&](Node& n) {
          n.to_parent = Eigen::Translation3d(away * scale, 0, 0) * Eigen::Scaling(scale) * n.to_parent;
        });
      View view = view_of(Vec3(away + 2, 1, 2.5) * scale, Vec3(away, 0, 0) * scale);
      view.camera.near_plane *= scale;
      view.camera.far_plane *= scale;
      for (int k = 0; k < 2; ++k) {
        view.camera.eye.y() += 0.1 * k * scale;
        renderers().expect_same_at_rest(scene, view, fmt::format("scale {}, {} away, {}", scale, away, k));
      }
    }
}

// Vertices far from their object's centre are rounded coarsely to float on the GPU; bounds must allow for it.
TEST(Occlusion, ChangesNoByteForCoarseFloats) {
  auto object = std::make_shared<BakedObject>(*made_object({.columns = 64, .rows = 32, .cell = 9}));
  TriangleSet half(object->triangle_count(), 0);
  std::fill(half.begin(), half.begin() + static_cast<std::ptrdiff_t>(half.size() / 2), 1);
  object->sets[0].soup =
      move_faces(object->sets[0].soup, half, 0, Affine(Eigen::Translation3d(2e5, 0, 0)), Mat3::Identity());
  const Scene scene = scene_of(object);
  for (const double angle : {0.0, 0.4, 0.8})
    renderers().expect_same_at_rest(scene, view_of({3 * std::sin(angle), 0.5, 3 * std::cos(angle)}, {0, 0, 0}),
                                    fmt::format("angle {}", angle));
}

TEST(Occlusion, ChangesNoByteOfSamplesAndOfEdits) {
  for (const char* name : {"ficus", "kettle"}) {
    Scene scene = read_any(std::filesystem::path(REBAKE_SOURCE) / "samples/scenes" / name, Axes::y_up);
    const Box box = world_bounds(scene);
    const double size = box.diagonal().norm();
    for (int edit = 0; edit < 3; ++edit) {
      for (int k = 0; k < 5; ++k) {
        const double turn = 1.3 * k;
        View view =
            view_of(box.center() + size * (0.25 + 0.2 * k) * Vec3(std::sin(turn), 0.3, std::cos(turn)), box.center());
        view.camera.near_plane = 0.01 * size;
        view.camera.far_plane = 5 * size;
        renderers().expect_same_at_rest(scene, view, fmt::format("{}, edit {}, view {}", name, edit, k));
      }
      // Half of the triangles are deleted, then half of the rest moves: remembered visibility belongs to other faces.
      const NodePtr node = scene.roots[0];
      auto object = std::make_shared<BakedObject>(*node->object);
      for (TextureSet& set : object->sets) {
        const std::size_t count = set.soup.triangle_count();
        TriangleSet flags(count, 0);
        for (std::size_t f = 0; f < count; ++f) flags[f] = f % 2 == 0 ? 1 : 0;
        const Mat3 turn = Eigen::AngleAxisd(0.3, Vec3::UnitY()).toRotationMatrix();
        set.soup = edit == 0 ? subset(set.soup, flags, 0, true) : move_faces(set.soup, flags, 0, Affine(turn), turn);
      }
      scene = with_changed(scene, node->id, [&](Node& n) { n.object = object; });
    }
  }
}

TEST(Occlusion, ChangesNoByteOfTheRealMic) {
  const auto mic = mic_object();
  if (!mic) GTEST_SKIP() << "REBAKE_TEST_DATA has no mic";
  const Scene scene = scene_of(mic);
  for (int k = 0; k < 10; ++k) {
    const double turn = 0.03 * k * k;
    View view = view_of({3.5 * std::sin(turn), 2 - 0.3 * k, 3.5 * std::cos(turn)}, {0, 0, 0});
    view.width = view.height = 400;
    renderers().expect_same_at_rest(scene, view, fmt::format("view {}", k));
  }
}

// As for two windows with one scene.
TEST(Occlusion, RemembersAlternatingViews) {
  const Scene scene = crowd();
  const View views[] = {view_of({3, 1, 0}, {0, 0, 0}), view_of({-1, 2, -3}, {0, 0, 0})};
  std::size_t last[2] = {};
  for (int k = 0; k < 6; ++k) {
    renderers().expect_same(scene, views[k % 2], fmt::format("{}", k));
    std::size_t drawn = 0;
    const std::string said = renderers().said();
    ASSERT_NE(said.find("; of "), std::string::npos) << said;
    ASSERT_EQ(std::sscanf(said.c_str() + said.find("; of "), "; of %*u triangles %zu were drawn", &drawn), 1) << said;
    if (k < 2) last[k] = drawn;
    if (k < 4) continue;
    EXPECT_LT(drawn, last[k % 2] * 7 / 10) << "the first frame draws everything: " << said;
  }
}

// Needles behind a wall: drivers extrapolate their depth so far that they appear in front of it.
TEST(Occlusion, ChangesNoByteForNeedlesBehindAWall) {
  auto object = std::make_shared<BakedObject>(*made_object({.columns = 4, .rows = 4, .holes = false}));
  const Vec2 uv = object->sets[0].soup.uvs()[0], other = object->sets[0].soup.uvs()[20];
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;
  std::vector<Face> faces;
  const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec2& at) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), {a, b, c});
    uvs.insert(uvs.end(), 3, at);
    faces.push_back({first, first + 1, first + 2});
  };
  for (int i = 0; i < 10; ++i)
    for (int k = 0; k < 10; ++k) {
      const Vec3 low(-1 + 0.2 * i, -1 + 0.2 * k, 0), x(0.2, 0, 0), y(0, 0.2, 0);
      add(low, low + x, low + x + y, uv);
      add(low, low + x + y, low + y, uv);
    }
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int k = 0; k < 20000; ++k) {
    const Vec3 center(0.8 * any(random), 0.8 * any(random), -0.02), along = Vec3(1, 0.05 * any(random), 0) * 0.05;
    const Vec3 across = Vec3(-along.y(), along.x(), 0).normalized() * 2e-5 * any(random);
    add(center - along, center + along, center + across + 0.3 * any(random) * along - Vec3(0, 0, 0.02), other);
  }
  object->sets[0].soup = Soup(positions, uvs, faces);
  const Scene scene = scene_of(object);
  for (int k = 0; k < 4; ++k) {
    View view = view_of({0.002 * k, 0, 2.5}, {0.002 * k, 0, 0});
    view.width = view.height = 400;
    renderers().expect_same_at_rest(scene, view, fmt::format("{}", k));
  }
}

TEST(Occlusion, OneTriangleAndNoTriangle) {
  auto object = std::make_shared<BakedObject>(*made_object({.columns = 4, .rows = 4}));
  TriangleSet one(object->triangle_count(), 0);
  renderers().expect_same(scene_of(object), view_of({0, 0, 3}, {0, 0, 0}), "few");
  one[one.size() / 2] = 1;
  object->sets[0].soup = subset(object->sets[0].soup, one, 0, true);
  renderers().expect_same(scene_of(object), view_of({0, 0, 3}, {0, 0, 0}), "one");
  one.assign(1, 0);
  object->sets[0].soup = subset(object->sets[0].soup, one, 0, true);
  renderers().expect_same(scene_of(object), view_of({0, 0, 3}, {0, 0, 0}), "none");
}

TEST(Occlusion, CullsTrianglesBehindASphere) {
  // One sphere inside another: all of the inner one and the far half of the outer one are hidden.
  Scene scene = scene_of(made_object({.columns = 128, .rows = 64, .cell = 5, .holes = false}));
  Node inner;
  inner.object = made_object({.columns = 128, .rows = 64, .cell = 5, .seed = 3, .radius = 0.9});
  scene = with_added(scene, inner, NodeId::none, 9);
  const View view = view_of({0, 0.4, 4}, {0, 0, 0});
  Renderer renderer;
  RenderOptions options;
  options.occlusion = Occlusion::on;
  const auto drawn = [&] {
    renderer.render(scene, view, options);
    for (const PlannedPass& pass : renderer.passes())
      if (pass.effect == &effects::occlusion) {
        std::size_t all = 0, some = 0;
        const std::size_t at = pass.why.find("; of ");
        EXPECT_EQ(std::sscanf(pass.why.c_str() + at, "; of %zu triangles %zu were drawn", &all, &some), 2) << pass.why;
        return static_cast<double>(some) / static_cast<double>(all);
      }
    return 1.0;
  };
  drawn();  // learns which triangles are visible
  EXPECT_LT(drawn(), 0.35) << "a quarter of the triangles is visible";
}

TEST(Occlusion, RunsWhereItPays) {
  const Scene few = scene_of(made_object()), many = scene_of(made_object({.columns = 200, .rows = 100, .cell = 3}));
  const View view = view_of({0, 0.4, 4}, {0, 0, 0});
  EXPECT_FALSE(plan(few, view).runs(effects::occlusion));
  EXPECT_TRUE(plan(many, view).runs(effects::occlusion));
  DeviceFacts device;
  device.visible_share = 0.9;
  EXPECT_FALSE(plan(many, view, {}, nullptr, nullptr, device).runs(effects::occlusion))
      << "nearly all triangles are visible";
  device = {.min_culling_triangles = 1'000'000};
  EXPECT_FALSE(plan(many, view, {}, nullptr, nullptr, device).runs(effects::occlusion))
      << "a GPU draws them faster than they are culled";
  Scene crumbs;
  const auto crumb = made_object({.columns = 5, .rows = 2, .cell = 5});
  for (int k = 0; k < 2000; ++k) {
    Node node;
    node.object = crumb;
    crumbs = with_added(crumbs, node, NodeId::none, static_cast<std::size_t>(k));
  }
  EXPECT_FALSE(plan(crumbs, view).runs(effects::occlusion)) << "40,000 triangles, 20 an object";
  RenderOptions off;
  off.occlusion = Occlusion::off;
  EXPECT_FALSE(plan(many, view, off).runs(effects::occlusion));
}

// If all triangles are visible, culling must not be tried in every frame.
TEST(Occlusion, PausesIfNothingIsHidden) {
  auto object = std::make_shared<BakedObject>(*made_object({.columns = 200, .rows = 100, .cell = 3, .holes = false}));
  std::vector<Vec3> flat;
  for (const Vec2& uv : object->sets[0].soup.uvs()) flat.emplace_back(uv.x() * 2 - 1, uv.y() * 2 - 1, 0);
  object->sets[0].soup = Soup(flat, object->sets[0].soup.uvs(), object->sets[0].soup.faces());
  const Scene scene = scene_of(object);
  View view = view_of({0, 0, 2.5}, {0, 0, 0});
  view.width = view.height = 800;
  Renderer renderer;
  if (renderer.device().find("llvmpipe") == std::string::npos) GTEST_SKIP() << "needs llvmpipe";
  int looked = 0;
  for (int k = 0; k < 20; ++k) {
    renderer.render(scene, view);
    for (const PlannedPass& pass : renderer.passes()) looked += pass.effect == &effects::occlusion && pass.runs ? 1 : 0;
  }
  EXPECT_GE(looked, 2) << "culling must be tried again";
  EXPECT_LE(looked, 3);
}

// Changes between frames at rest are noticed: newly uncovered and newly occluding objects.
TEST(Occlusion, NoticesChangesAtRest) {
  const Scene scene = crowd();
  const View view = view_of({3, 1, 0}, {0, 0, 0});
  renderers().expect_same_at_rest(scene, view, "before");
  EXPECT_NE(renderers().said().find("nothing has moved"), std::string::npos) << renderers().said();
  // Half of the first object's texels become transparent.
  const auto holes = [&](std::size_t root) {
    return with_changed(scene, scene.roots[root]->id, [&](Node& node) {
      auto object = std::make_shared<BakedObject>(*node.object);
      FeatureTexture::Change change(*object->sets[0].texels);
      for (int y = 0; y < object->sets[0].texels->height(); ++y)
        for (int x = 0; x < object->sets[0].texels->width() / 2; ++x) change.at(x, y).feat0[0] = 0;
      object->sets[0].texels = change.finish();
      node.object = std::move(object);
    });
  };
  renderers().expect_same(holes(0), view, "erased");
  EXPECT_EQ(renderers().said().find("nothing has moved"), std::string::npos);
  renderers().expect_same_at_rest(scene, view, "undone");
  // A node is replaced by another one.
  Node copy = *scene.roots[3];
  copy.id = NodeId::none;
  Scene swapped = with_added(scene, copy, NodeId::none, 4);
  swapped.roots.erase(swapped.roots.begin() + 3);
  renderers().expect_same_at_rest(swapped, view, "swapped");
  renderers().expect_same_at_rest(scene, view, "swapped back");
  Scene moved =
      with_changed(scene, scene.roots[2]->id, [](Node& node) { node.to_parent.translation() = Vec3(1.5, 0, 0); });
  renderers().expect_same_at_rest(moved, view, "moved in front");
  moved.background = Color(0, 0, 0);
  renderers().expect_same(moved, view, "another background");
}

}  // namespace
}  // namespace rebake::test
