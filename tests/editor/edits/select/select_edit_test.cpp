// Selection edits: the triangle nearest to a point, modes, and several objects at once.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "editor/edits/edit.h"
#include "editor/edits/select/selecting.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/mesh/point_triangle.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

// Distance is measured to triangles, not to their centres: points lie on the large one, near the centre of the small
// one.
TEST(SelectEdit, NearestTriangleIsNotTheOneWithTheNearestCentre) {
  auto object = std::make_shared<BakedObject>(*made_object());
  const std::vector<Vec3> positions{{-15, 0, -15}, {15, 0, -15}, {0, 0, 15}, {4, 0.6, 4}, {5, 0.6, 4}, {4, 0.6, 5}};
  object->sets = {
      {Soup(positions, std::vector<Vec2>(6, Vec2(0.5, 0.5)), {Face{0, 1, 2}, Face{3, 4, 5}}), object->sets[0].texels}};
  const Scene scene = scene_of(object, "floor");
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0, 1);
  for (int k = 0; k < 100; ++k) {
    const std::size_t wanted = k % 2;
    double s = share(random), t = share(random);
    if (s + t > 1) s = 1 - s, t = 1 - t;
    const Vec3* p = &positions[3 * wanted];
    const Vec3 point = p[0] + s * (p[1] - p[0]) + t * (p[2] - p[0]);
    const nlohmann::json line{{"op", "select"}, {"connected", {point.x(), point.y(), point.z()}}};
    const Scene selected = apply(scene, read_edit(line, scene)).scene;
    EXPECT_EQ((*selected.roots[0]->selection)[wanted], 1) << point.transpose();
    EXPECT_EQ(count(*selected.roots[0]->selection), 1U);
  }
}

// Texture sets and triangles that are too far away are skipped; the result equals a search through all of them.
TEST(SelectEdit, NearestTriangleMatchesLinearSearch) {
  auto object = std::make_shared<BakedObject>(*made_object({.columns = 12, .rows = 6}));
  for (unsigned seed = 2; seed < 5; ++seed) {
    object->sets.push_back(made_object({.columns = 12, .rows = 6, .seed = seed, .radius = 0.4 * seed})->sets[0]);
  }
  Scene scene = scene_of(object, "one");
  Node other;
  other.name = "other";
  other.object = object;
  other.to_parent = Eigen::Translation3d(1.5, 0, 0) * Eigen::AngleAxisd(1, Vec3(1, 2, 3).normalized()) *
                    Eigen::Scaling(Vec3(0.5, 1, 2));
  scene = with_added(scene, std::move(other), NodeId::none, 1);
  const std::vector<PlacedNode> targets = selectable(scene, std::nullopt);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-3, 3);
  for (int k = 0; k < 200; ++k) {
    const Vec3 point(any(random), any(random), any(random));
    const auto distance_of = [&](std::size_t target, std::size_t wanted) {
      for (const TextureSet& set : targets[target].node->object->sets) {
        if (wanted >= set.soup.triangle_count()) {
          wanted -= set.soup.triangle_count();
          continue;
        }
        const Face& face = set.soup.faces()[wanted];
        std::array<Vec3, 3> p;
        for (std::size_t i = 0; i < 3; ++i) p[i] = targets[target].to_world * set.soup.positions()[face[i]];
        return distance_to_triangle(p[0], p[1], p[2], point);
      }
      return std::numeric_limits<double>::infinity();
    };
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t target = 0; target < targets.size(); ++target)
      for (std::size_t f = 0; f < object->triangle_count(); ++f) least = std::min(least, distance_of(target, f));
    const NearestTriangle found = nearest_triangle(targets, point, false);
    EXPECT_NEAR(distance_of(found.target, found.triangle), least, 1e-14) << point.transpose();
  }
}

TEST(SelectEdit, InvertObeysItsMode) {
  const Scene scene = scene_of(made_object(), "ball");
  for (const auto& [mode, wanted] :
       {std::pair("set", 1.0), std::pair("add", 1.0), std::pair("remove", 0.0), std::pair("intersect", 0.0)}) {
    const nlohmann::json line{{"op", "select"}, {"invert", true}, {"mode", mode}};
    const Scene selected = apply(scene, read_edit(line, scene)).scene;
    const auto& flags = selected.roots[0]->selection;
    EXPECT_EQ(flags ? count(*flags) : 0U, wanted * 256) << mode;
  }
}

TEST(SelectEdit, SelectsTextureSetOfSomeObjects) {
  auto two = std::make_shared<BakedObject>(*made_object());
  two->sets.push_back(made_object({.seed = 2, .radius = 0.5})->sets[0]);
  Scene scene = scene_of(made_object(), "one");
  Node node;
  node.name = "two";
  node.object = two;
  scene = with_added(scene, std::move(node), NodeId::none, 1);
  const auto set = [&](int number) {
    return apply(scene, read_edit(nlohmann::json{{"op", "select"}, {"texture_set", number}}, scene)).scene;
  };
  EXPECT_FALSE(set(1).roots[0]->selection);
  EXPECT_EQ(count(*set(1).roots[1]->selection), 256U);
  EXPECT_THROW(set(2), FieldError);
}

// On a group, commands that start from the present selection use all nodes in it.
TEST(SelectEdit, GroupMeansAllNodesInIt) {
  Scene scene = scene_of(made_object(), "ball");
  const auto act = [&](const char* line) {
    scene = apply(scene, read_edit(nlohmann::json::parse(line), scene)).scene;
    std::size_t selected = 0;
    for (const PlacedNode& placed : placed_nodes(scene))
      if (placed.node->selection) selected += count(*placed.node->selection);
    return selected;
  };
  act(R"({"op": "group", "nodes": ["ball"], "as": "g"})");
  EXPECT_EQ(act(R"({"op": "select_triangles", "node": "ball", "triangles": [[0, 9]]})"), 10U);
  const std::size_t grown = act(R"({"op": "grow", "node": "g"})");
  EXPECT_GT(grown, 10U);
  EXPECT_LT(act(R"({"op": "shrink", "node": "g"})"), grown);
  EXPECT_EQ(act(R"({"op": "select_connected", "node": "g"})"), 256U);
  act(R"({"op": "select_triangles", "node": "ball", "triangles": [[0, 9]]})");
  EXPECT_THROW(act(R"({"op": "separate", "node": "g"})"), EditError) << "separate needs a node, not a group";
  EXPECT_EQ(act(R"({"op": "delete", "node": "g"})"), 0U);
  EXPECT_EQ(placed_nodes(scene).back().node->object->triangle_count(), 246U);
}

TEST(SelectEdit, OrientationsDifferByAtMost90Degrees) {
  auto object = std::make_shared<BakedObject>(*made_object());
  // Triangles in the planes xy, yz and xz, and a degenerate one.
  const std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  object->sets = {{Soup(positions, std::vector<Vec2>(4, Vec2(0.5, 0.5)),
                        {Face{0, 1, 2}, Face{0, 2, 3}, Face{0, 3, 1}, Face{1, 1, 1}}),
                   object->sets[0].texels}};
  const Scene scene = scene_of(object, "planes");
  const auto like = [&](unsigned triangle, double degrees) {
    const nlohmann::json pick{
        {"op", "select_triangles"}, {"node", "planes"}, {"triangles", nlohmann::json::array({triangle})}};
    const Scene picked = apply(scene, read_edit(pick, scene)).scene;
    const nlohmann::json line{{"op", "select_like"}, {"orientation", degrees}};
    return count(*apply(picked, read_edit(line, picked)).scene.roots[0]->selection);
  };
  EXPECT_EQ(like(0, 90), 3U);
  EXPECT_EQ(like(0, 89), 1U);
  EXPECT_THROW(like(3, 10), FieldError) << "a degenerate triangle has no plane";
}

TEST(SelectEdit, TransparentTrianglesDoNotCountInTheMeanColour) {
  const Scene scene = scene_of(made_object(), "ball");
  const auto act = [](const Scene& on, const nlohmann::json& line) { return apply(on, read_edit(line, on)).scene; };
  const Scene erased =
      act(scene, {{"op", "erase"}, {"node", "ball"}, {"sphere", {{"center", {0, 1, 0}}, {"radius", 0.9}}}});
  const auto traits = traits_of(*erased.roots[0]->object);
  std::vector<unsigned> opaque, transparent;
  for (unsigned f = 0; f < traits->size(); ++f) ((*traits)[f].opacity > 0 ? opaque : transparent).push_back(f);
  ASSERT_FALSE(transparent.empty());
  const auto like = [&](const std::vector<unsigned>& picked, const char* field) {
    const Scene with = act(erased, {{"op", "select_triangles"}, {"node", "ball"}, {"triangles", picked}});
    return *act(with, {{"op", "select_like"}, {field, 0.05}}).roots[0]->selection;
  };
  const unsigned one = opaque.front();
  for (const char* field : {"color", "features"}) {
    EXPECT_GE(count(like({one}, field)), 1U);
    EXPECT_EQ(like({one, transparent.front()}, field), like({one}, field)) << field;
  }
}

TEST(SelectEdit, RotatedCopiesHaveTheSameSize) {
  auto object = std::make_shared<BakedObject>(*made_object());
  // Two triangles of area 0.5, the second one turned.
  const std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0.6, 0.8}};
  object->sets = {
      {Soup(positions, std::vector<Vec2>(4, Vec2(0.5, 0.5)), {Face{0, 1, 2}, Face{0, 1, 3}}), object->sets[0].texels}};
  const Scene scene = scene_of(object, "two");
  for (const double y : {0.2, 0.19}) {
    const nlohmann::json line{{"op", "select_like"}, {"point", {0.2, y, y == 0.2 ? 0.0 : 0.3}}, {"size", 1}};
    EXPECT_EQ(count(*apply(scene, read_edit(line, scene)).scene.roots[0]->selection), 2U) << y;
  }
}

// A triangle that meets any criterion is selected, so another criterion never selects fewer.
TEST(SelectEdit, UnneededByTwoCriteriaIsTheUnionOfBoth) {
  Scene scene = scene_of(made_object({.holes = false}), "ball");
  const auto act = [&](const nlohmann::json& line) {
    scene = apply(scene, read_edit(line, scene)).scene;
    const auto& selection = scene.roots[0]->selection;
    return selection ? *selection : TriangleSet(scene.roots[0]->object->triangle_count(), 0);
  };
  act({{"op", "view"}, {"name", "front"}, {"camera", {{"eye", {0, 0, 5}}, {"target", {0, 0, 0}}}}});
  const nlohmann::json from{{"op", "select_unneeded"}, {"unseen_from", {"front"}}};
  const TriangleSet behind = act(from);
  ASSERT_GT(count(behind), 50U);
  nlohmann::json both = from;
  both["unseen"] = 50;
  const TriangleSet wider = act(both);
  for (std::size_t f = 0; f < behind.size(); ++f) EXPECT_GE(wider[f], behind[f]);
}

TEST(SelectEdit, VisibleTrianglesInAPictureDoNotDependOnTheScale) {
  std::vector<std::size_t> counts;
  for (const double scale : {1.0, 1e15, 1e17, 1e20}) {
    Scene scene = scene_of(made_object({.holes = false}), "ball");
    scene = with_changed(scene, scene.roots[0]->id,
                         [&](Node& node) { node.to_parent = Affine(Eigen::UniformScaling<double>(scale)); });
    const nlohmann::json line{{"op", "select_picture"},
                              {"polygon", {{30, 0}, {64, 0}, {64, 34}, {30, 34}}},
                              {"size", {64, 64}},
                              {"camera", {{"eye", {0, 0, 5 * scale}}, {"target", {0, 0, 0}}, {"fov", 40}}}};
    const auto selection = apply(scene, read_edit(line, scene)).scene.roots[0]->selection;
    counts.push_back(selection ? count(*selection) : 0);
  }
  EXPECT_GT(counts[0], 10U);
  for (const std::size_t one : counts) EXPECT_EQ(one, counts[0]);
}

TEST(SelectEdit, SpheresInTheBoundsOfAFlatObjectDoNotDependOnItsSize) {
  for (const double size : {0.1, 1.0, 100.0}) {
    auto object = std::make_shared<BakedObject>(*made_object());
    const std::vector<Vec3> floor{{0, 0, 0}, {size, 0, 0}, {size, 0, size}, {0, 0, size}};
    object->sets = {
        {Soup(floor, std::vector<Vec2>(4, Vec2(0.5, 0.5)), {Face{0, 1, 2}, Face{0, 2, 3}}), object->sets[0].texels}};
    const Scene scene = scene_of(object, "floor");
    const nlohmann::json line{
        {"op", "select"}, {"frame", "bounds"}, {"sphere", {{"center", {0.5, 0.5, 0.5}}, {"radius", 0.3}}}};
    const auto selection = apply(scene, read_edit(line, scene)).scene.roots[0]->selection;
    ASSERT_NE(selection, nullptr) << size;
    EXPECT_EQ(count(*selection), 2U) << size;
  }
}

// One edit for several nodes: texels that it uncovers stay. A hidden node that is named occludes itself.
TEST(SelectEdit, ErasingInAPictureClearsOnlyWhatWasVisible) {
  Scene scene = scene_of(made_object({.radius = 2, .holes = false}), "front");
  Node behind;
  behind.name = "behind";
  behind.object = made_object({.holes = false});
  behind.to_parent.translation() = Vec3(0, 0, -6);
  scene = with_added(scene, behind, NodeId::none, 9);
  nlohmann::json line{{"op", "erase"},
                      {"nodes", {"front", "behind"}},
                      {"brush", {{"points", {{32, 32}}}, {"radius", 6}}},
                      {"size", {64, 64}},
                      {"camera", {{"eye", {0, 0, 8}}, {"target", {0, 0, 0}}}}};
  const auto texels = [](const Scene& of, std::size_t node) { return of.roots[node]->object->opaque_texel_count(); };
  const Scene erased = apply(scene, read_edit(line, scene)).scene;
  EXPECT_LT(texels(erased, 0), texels(scene, 0));
  EXPECT_EQ(texels(erased, 1), texels(scene, 1));
  line["node"] = "front";
  EXPECT_THROW(apply(scene, read_edit(line, scene)), FieldError) << "node and nodes";
  line.erase("nodes");
  Scene hidden = with_changed(scene, scene.roots[0]->id, [](Node& node) { node.visible = false; });
  const auto cleared = [&](const Scene& of) { return texels(of, 0) - texels(apply(of, read_edit(line, of)).scene, 0); };
  EXPECT_EQ(cleared(hidden), cleared(scene)) << "not its back";
}

// Triangles in front of the near plane are not drawn and must not occlude others for erase.
TEST(SelectEdit, ErasingSeesThroughWhatTheNearPlaneCuts) {
  Scene scene = scene_of(made_object({.holes = false}), "ball");
  Node wall;
  wall.name = "wall";
  wall.object = made_object({.radius = 3, .holes = false});
  scene = with_added(scene, wall, NodeId::none, 9);
  const auto erased = [&](double near) {
    const nlohmann::json line{{"op", "erase"},
                              {"node", "ball"},
                              {"depth", {0, 100}},
                              {"size", {64, 64}},
                              {"camera", {{"eye", {0, 0, 8}}, {"target", {0, 0, 0}}, {"near", near}, {"far", 20}}}};
    return apply(scene, read_edit(line, scene)).scene.roots[0]->object != scene.roots[0]->object;
  };
  EXPECT_TRUE(erased(6));
  EXPECT_THROW(erased(1), EditError) << "the larger ball hides it";
}

}  // namespace
}  // namespace rebake::test
