// Holes that removed triangles leave: borders, patches, and the features that continue.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "editor/edits/edit.h"
#include "editor/edits/shape/fill_holes.h"
#include "editor/edits/shape/fill_report.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/fill/filled_holes.h"
#include "mesh_ops/fill/hole_patch.h"
#include "mesh_ops/fill/patch_texture.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/index/footprint.h"
#include "tests/support/made_scenes.h"
#include "tests/support/nerf2mesh_example.h"
#include "tests/support/script_fixture.h"

namespace rebake::test {
namespace {

std::shared_ptr<const BakedObject> ball() {
  return made_object({.columns = 64, .rows = 32, .cell = 9, .holes = false});
}

// The triangles whose centroid is within `radius` of a point.
TriangleSet near_point(const BakedObject& object, const Vec3& point, double radius) {
  TriangleSet flags;
  for (const TextureSet& set : object.sets)
    for (const Face& face : set.soup.faces()) {
      Vec3 centre = Vec3::Zero();
      for (const std::uint32_t v : face) centre += set.soup.positions()[v] / 3;
      flags.push_back((centre - point).norm() < radius ? 1 : 0);
    }
  return flags;
}

TEST(FillHoles, SurfacesContinueSmoothly) {
  const auto object = ball();
  for (const double radius : {0.15, 0.3, 0.5}) {
    const TriangleSet removed = near_point(*object, {0, 0, 1}, radius);
    const FilledHoles filled = filled_holes(*object, removed);
    ASSERT_EQ(filled.holes, 1U);
    EXPECT_EQ(filled.open_edges, 0U);
    EXPECT_EQ(filled.removed, count(removed));
    ASSERT_EQ(filled.object->sets.size(), 2U);
    EXPECT_EQ(filled.object->triangle_count(), object->triangle_count() - filled.removed + filled.triangles);
    double worst = 0;
    for (const Vec3& p : filled.object->sets[1].soup.positions()) worst = std::max(worst, std::abs(p.norm() - 1));
    // A flat lid would be off by about radius² / 2.
    EXPECT_LE(worst, 0.4 * radius * radius / 2 + 2e-3) << radius;
    // The patch is closed: nothing of its border is left.
    TriangleSet patch(filled.object->triangle_count(), 0);
    std::fill(patch.end() - static_cast<std::ptrdiff_t>(filled.triangles), patch.end(), 1);
    const HoleLoops border = hole_loops(*filled.object, patch, 1e-6);
    ASSERT_EQ(border.loops.size(), 1U);
    EXPECT_EQ(border.loops[0].points.size(), hole_loops(*object, removed, 1e-6).loops[0].points.size());
  }
}

// Every hole that stays open is counted under its reason.
TEST(FillHoles, SaysWhyHolesStayOpen) {
  const auto whole = ball();
  TriangleSet gone = near_point(*whole, {0, 0, 1}, 0.5);
  const TriangleSet other = near_point(*whole, {1, 0, 0}, 0.15);
  const std::size_t large = hole_loops(*whole, gone, 1e-6).loops.front().points.size(),
                    small = hole_loops(*whole, other, 1e-6).loops.front().points.size();
  ASSERT_LT(small, large);
  for (std::size_t f = 0; f < gone.size(); ++f) gone[f] |= other[f];
  BakedObject open = *whole;
  open.sets[0].soup = subset(whole->sets[0].soup, gone, 0, false);
  const TriangleSet all(open.triangle_count(), 1);
  const FilledHoles one = filled_open_holes(open, all, small);
  EXPECT_EQ(one.holes, 1U);
  EXPECT_EQ(one.longer, 1U);
  EXPECT_EQ(unfilled_words(one, small), fmt::format("1 has more than {} edges (raise longest)", small));
  EXPECT_EQ(filled_open_holes(open, all, large).unfilled(), 0U);
  const FilledHoles most = filled_open_holes(open, all, small - 1);
  EXPECT_EQ(most.longer, 2U);
  // Without UVs, raising the limit does not help.
  BakedObject plain = open;
  const Soup& soup = open.sets[0].soup;
  plain.sets[0].soup = Soup(soup.positions(), std::vector<Vec2>(soup.uvs().size(), Vec2(0.5, 0.5)), soup.faces());
  const FilledHoles none = filled_open_holes(plain, all, small);
  EXPECT_EQ(none.holes, 0U);
  EXPECT_EQ(none.longer, 1U);
  EXPECT_EQ(none.untextured, 1U);
  EXPECT_EQ(unfilled_words(none, small),
            fmt::format("1 has more than {} edges (raise longest), 1 has no opaque texels around", small));
  Node node;
  node.object = std::make_shared<const BakedObject>(plain);
  node.selection = std::make_shared<const TriangleSet>(all);
  FillHoles edit;
  edit.longest = 2000;
  try {
    apply(with_added({}, node, NodeId::none, 0), Edit(edit));
    FAIL();
  } catch (const EditError& error) {
    EXPECT_NE(std::string(error.what()).find("2 borders stay open: 2 have no opaque texels around"), std::string::npos)
        << error.what();
  }
}

// The ball with features that are smooth functions of the place.
std::shared_ptr<const BakedObject> smooth_ball() {
  auto object = std::make_shared<BakedObject>(*ball());
  TextureSet& set = object->sets[0];
  FeatureTexture::Change change(*set.texels);
  for (std::size_t f = 0; f < set.soup.triangle_count(); ++f) {
    const std::array<Vec2, 3> uv = texel_corners(set, f);
    const auto& p = set.soup.positions();
    const Face& face = set.soup.faces()[f];
    for_each_texel_piece(
        uv, set.texels->width(), set.texels->height(), [&](int x, int y, double, const Vec2& centroid) {
          const Vec3 w = barycentric(uv, centroid);
          const Vec3 at = w[0] * p[face[0]] + w[1] * p[face[1]] + w[2] * p[face[2]];
          for (std::size_t c = 0; c < 8; ++c) {
            const double phase = at.dot(Vec3(1 + static_cast<double>(c % 3), 2 - static_cast<double>(c % 2), 1)) +
                                 static_cast<double>(c);
            const auto byte = static_cast<std::uint8_t>(
                std::lround(c % 4 == 3 ? 191 + 60 * std::sin(phase) : 128 + 100 * std::sin(phase)));
            (c < 4 ? change.at(x, y).feat0 : change.at(x, y).feat1)[c % 4] = byte;
          }
        });
  }
  set.texels = change.finish();
  return object;
}

TEST(FillHoles, FeaturesContinueFromTheBorder) {
  const auto object = smooth_ball();
  const TriangleSet removed = near_point(*object, {0, 0, 1}, 0.3);
  const FilledHoles filled = filled_holes(*object, removed);
  const TextureSet &set = filled.object->sets[1], &before = object->sets[0];
  const TexelReader texels(*set.texels), old(*before.texels);
  double squares = 0;
  std::vector<Eigen::Array<double, 8, 1>> truths;
  for (const Face& face : set.soup.faces()) {
    Vec3 centre = Vec3::Zero();
    Vec2 uv = Vec2::Zero();
    for (const std::uint32_t v : face) centre += set.soup.positions()[v] / 3, uv += set.soup.uvs()[v] / 3;
    // The removed triangle whose centroid is nearest.
    double least = 1e9;
    Texel truth;
    for (std::size_t f = 0; f < removed.size(); ++f) {
      if (removed[f] == 0) continue;
      Vec3 there = Vec3::Zero();
      Vec2 at = Vec2::Zero();
      for (const std::uint32_t v : before.soup.faces()[f])
        there += before.soup.positions()[v] / 3, at += before.soup.uvs()[v] / 3;
      if ((there - centre).norm() >= least) continue;
      least = (there - centre).norm();
      truth = old.sample(at.x(), at.y());
    }
    const auto made = decode_features(texels.sample(uv.x(), uv.y()), set.texels->alpha_code()),
               wanted = decode_features(truth, before.texels->alpha_code());
    truths.push_back(Eigen::Map<const Eigen::Array<double, 8, 1>>(wanted.data()));
    squares += (Eigen::Map<const Eigen::Array<double, 8, 1>>(made.data()) - truths.back()).square().sum();
  }
  // One feature vector, the mean of the truth, is the best that a patch without variation could have.
  Eigen::Array<double, 8, 1> mean = Eigen::Array<double, 8, 1>::Zero();
  for (const auto& features : truths) mean += features / static_cast<double>(truths.size());
  double constant = 0;
  for (const auto& features : truths) constant += (features - mean).square().sum();
  EXPECT_LT(squares, 0.1 * constant);
  EXPECT_LT(std::sqrt(squares / (8 * static_cast<double>(truths.size()))), 0.03);
  EXPECT_GT(filled.texels, 0U);
  EXPECT_EQ(set.texels->opaque_count(),
            static_cast<std::uint64_t>(set.texels->width()) * static_cast<unsigned>(set.texels->height()));
}

TEST(FillHoles, SizeAndPlaceDoNotMatter) {
  const auto object = ball();
  const TriangleSet removed = near_point(*object, {0, 0, 1}, 0.3);
  const FilledHoles reference = filled_holes(*object, removed);
  for (const auto& [scale, offset] : {std::pair(1e-6, 0.0), {1e6, 0.0}, {1.0, 1e5}}) {
    BakedObject other = *object;
    std::vector<Vec3> positions = object->sets[0].soup.positions();
    for (Vec3& p : positions) p = scale * p + Vec3(offset, -offset, offset);
    other.sets[0].soup = Soup(std::move(positions), object->sets[0].soup.uvs(), object->sets[0].soup.faces());
    const FilledHoles filled = filled_holes(other, removed);
    EXPECT_EQ(filled.holes, 1U);
    EXPECT_NEAR(static_cast<double>(filled.triangles), static_cast<double>(reference.triangles),
                0.1 * static_cast<double>(reference.triangles));
    const double area = patch_area(reference, Affine::Identity());
    EXPECT_NEAR(patch_area(filled, Affine::Identity()) / (scale * scale), area, 0.01 * area);
    EXPECT_NEAR(patch_area(filled, Affine(Eigen::Scaling(2 / scale))), 4 * area, 0.04 * area) << "in the scene's units";
  }
}

TEST(FillHoles, SmallHolesAndSeveral) {
  const auto object = ball();
  TriangleSet removed(object->triangle_count(), 0);
  removed[700] = 1;
  const FilledHoles one = filled_holes(*object, removed);
  EXPECT_EQ(one.holes, 1U);
  EXPECT_EQ(one.triangles, 1U);
  removed = near_point(*object, {0, 0, 1}, 0.2);
  const TriangleSet other = near_point(*object, {1, 0, 0}, 0.2);
  for (std::size_t f = 0; f < removed.size(); ++f) removed[f] |= other[f];
  EXPECT_EQ(filled_holes(*object, removed).holes, 2U);
}

TEST(HoleLoops, SeparateWhereTheyTouch) {
  // A square grid of 4 × 4 quads; two quads that share one corner are removed.
  std::vector<Vec3> positions;
  std::vector<Face> faces;
  TriangleSet removed;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      const auto first = static_cast<std::uint32_t>(positions.size());
      for (const auto& [dx, dy] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)})
        positions.emplace_back(x + dx, y + dy, 0);
      faces.push_back({first, first + 1, first + 2});
      faces.push_back({first, first + 2, first + 3});
      const bool hole = (x == 1 && y == 1) || (x == 2 && y == 2);
      removed.insert(removed.end(), 2, hole ? 1 : 0);
    }
  BakedObject object;
  object.decoder = std::make_shared<const Decoder>(diffuse_decoder());
  const auto texels = FeatureTexture::from_rows(2, 2, AlphaCode::plain, [](int, Texel* row) {
    row[0] = row[1] = {{255, 1, 2, 3}, {0, 0, 0, 255}};
  });
  object.sets.push_back({Soup(positions, std::vector<Vec2>(positions.size(), Vec2(0.3, 0.3)), faces),
                         std::make_shared<const FeatureTexture>(texels)});
  const HoleLoops found = hole_loops(object, removed, 0);
  ASSERT_EQ(found.loops.size(), 2U);
  EXPECT_EQ(found.loops[0].points.size(), 4U);
  EXPECT_EQ(found.loops[1].points.size(), 4U);
  EXPECT_EQ(found.open_edges, 0U);
}

// Regular borders have several equally good triangulations; memory addresses must not decide among them.
TEST(HolePatch, RegularBordersAreFilledTheSameEveryTime) {
  std::mt19937 random(1);
  std::vector<std::unique_ptr<char[]>> blocks;  // so that addresses differ between the calls
  for (std::size_t points = 4; points < 64; points += 3)
    for (const bool square : {true, false}) {
      const Mat3 turn = Eigen::AngleAxisd(0.7 * static_cast<double>(points % 3), Vec3(1, 2, 3).normalized()).matrix();
      HoleLoop loop;
      for (std::size_t k = 0; k < points; ++k) {
        const double angle = 2 * EIGEN_PI * static_cast<double>(k) / static_cast<double>(points);
        Vec3 point(std::cos(angle), std::sin(angle), 0);
        if (square) point /= point.cwiseAbs().maxCoeff();
        loop.points.emplace_back(turn * point);
        loop.outer_points.emplace_back(turn * (1.2 * point - Vec3(0, 0, square ? 0 : 0.3)));
      }
      const HolePatch first = hole_patch(loop);
      EXPECT_FALSE(first.faces.empty());
      for (int call = 0; call < 8; ++call) {
        for (int k = 0; k < 60; ++k) blocks.push_back(std::make_unique<char[]>(16 + random() % 3000));
        for (std::size_t k = random() % 2; k < blocks.size(); k += 2) blocks[k].reset();
        const HolePatch again = hole_patch(loop);
        EXPECT_EQ(again.vertices, first.vertices) << points << (square ? ", square" : ", circle");
        EXPECT_EQ(again.faces, first.faces) << points << (square ? ", square" : ", circle");
      }
    }
}

TEST(HarmonicFeatures, StayWithinTheBorder) {
  HolePatch patch;
  patch.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, 0.3, 0}};
  patch.faces = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  const std::array<double, 8> low{1, 2, 3, 4, 5, 6, 7, 8}, high{9, 9, 9, 9, 9, 9, 9, 9};
  const PatchFeatures mixed = harmonic_features(patch, {low, high, std::nullopt});
  ASSERT_EQ(mixed.size(), 4U);
  for (std::size_t c = 0; c < 8; ++c) {
    EXPECT_GT(mixed[3][c], low[c] - 1e-9);
    EXPECT_LT(mixed[3][c], high[c] + 1e-9);
  }
  for (const auto& features : harmonic_features(patch, {low, low, low}))
    for (std::size_t c = 0; c < 8; ++c) EXPECT_NEAR(features[c], low[c], 1e-12);
  EXPECT_TRUE(harmonic_features(patch, {std::nullopt, std::nullopt, std::nullopt}).empty());
}

TEST_F(Script, DeleteAndFillClosesWhatItRemoves) {
  run(import + R"({"op": "select", "node": "ball", "sphere": {"center": [0, 0, 1], "radius": 0.5}}
{"op": "store_selection", "name": "lid"}
{"op": "delete_and_fill"}
{"op": "export", "out": "{here}/filled"})");
  EXPECT_EQ(node("ball")->object->sets.size(), 2U);
  EXPECT_EQ(read_any(folder_.path() / "filled", Axes::y_up).roots[0]->object->triangle_count(),
            node("ball")->object->triangle_count());
  expect_error(R"({"op": "select", "all": true})"
               "\n"
               R"({"op": "delete_and_fill"})",
               "all triangles are selected");
}

// Keyframed bends move stored selections: a patch amid one must follow.
TEST_F(Script, PatchesBelongToTheStoredSelectionsAroundThem) {
  run(import + R"({"op": "select", "node": "ball", "half_space": {"point": [0, 0, 0], "normal": [0, 0, 1]}}
{"op": "store_selection", "name": "front"}
{"op": "select", "node": "ball", "sphere": {"center": [1, 0, 0.2], "radius": 0.6}}
{"op": "store_selection", "name": "side"}
{"op": "select", "node": "ball", "sphere": {"center": [0, 0, 1], "radius": 0.5}}
{"op": "delete_and_fill"})");
  const BakedObject& object = *node("ball")->object;
  const std::size_t patch = object.sets.back().soup.triangle_count(), all = object.triangle_count();
  ASSERT_GT(patch, 0U);
  const auto in_patch = [&](const char* name) {
    const TriangleSet& flags = *node("ball")->saved_selections.at(name);
    EXPECT_EQ(flags.size(), all);
    return static_cast<std::size_t>(std::count(flags.end() - static_cast<std::ptrdiff_t>(patch), flags.end(), 1));
  };
  EXPECT_EQ(in_patch("front"), patch);
  EXPECT_EQ(in_patch("side"), 0U);
}

TEST(PatchTexture, PatchesOfManyTexelsStillHaveTheirOwn) {
  // 40,000 triangles of 63 texels each would need three pages.
  HolePatch patch;
  std::vector<PatchFeatures> features(1);
  for (std::uint32_t k = 0; k < 40000; ++k) {
    for (const auto& [x, y] : {std::pair(0.0, 0.0), std::pair(1.0, 0.0), std::pair(0.0, 1.0)}) {
      patch.vertices.emplace_back(x, y, k);
      features[0].push_back({static_cast<double>(1 + k % 250), 0, 0, 0, 0, 0, 0, 0});
    }
    patch.faces.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  std::vector<std::size_t> patch_of;
  const TextureSet set = textured_patches({patch}, features, 0.01, AlphaCode::plain, patch_of);
  EXPECT_EQ(patch_of.size(), 40000U);
  const TexelReader texels(*set.texels);
  for (std::size_t f = 0; f < set.soup.triangle_count(); f += 97) {
    const Vec2& uv = set.soup.uvs()[set.soup.faces()[f][0]];
    const int x = static_cast<int>(uv.x() * set.texels->width()),
              y = static_cast<int>((1 - uv.y()) * set.texels->height());
    const auto number = static_cast<std::uint32_t>(set.soup.positions()[set.soup.faces()[f][0]].z());
    ASSERT_EQ(texels.at(x, y).feat0[0], 1 + number % 250) << f;
  }
}

TEST(FillHoles, WorksInNerf2MeshFolders) {
  const TemporaryFolder folder;
  write_nerf2mesh_example(folder.path() / "n");
  Scene scene = read_any(folder.path() / "n", Axes::y_up);
  const BakedObject& object = *scene.roots[0]->object;
  const FilledHoles filled = filled_holes(object, near_point(object, {1, 0, 0}, 0.6));
  ASSERT_EQ(filled.holes, 1U);
  scene = with_changed(scene, scene.roots[0]->id, [&](Node& node) { node.object = filled.object; });
  format_named("nerf2mesh").write(scene, folder.path() / "out", {}, {});
  EXPECT_EQ(read_any(folder.path() / "out", Axes::y_up).roots[0]->object->sets.size(), 2U);
}

}  // namespace
}  // namespace rebake::test
