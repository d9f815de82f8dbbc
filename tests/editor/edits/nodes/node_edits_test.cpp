// Edits of nodes: placing, dropping, aligning, grouping, copying, merging.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "editor/edits/nodes/place.h"
#include "mesh_ops/base/polar.h"
#include "tests/support/made_scenes.h"
#include "tests/support/script_fixture.h"
#include "tests/support/thorough.h"

namespace rebake::test {
namespace {

class NodeEdits : public Script {};

TEST_F(NodeEdits, DeleteSeparateGroupReorderRename) {
  run(import +
      R"({"op": "select", "node": "ball", "half_space": {"point": [0, 0, 0], "normal": [0, 1, 0]}})"
      "\n" +
      R"({"op": "separate", "node": "ball", "as": "top"})");
  EXPECT_EQ(node("top")->object->triangle_count(), 128U);
  EXPECT_EQ(node("ball")->object->triangle_count(), 128U);
  EXPECT_EQ(node("top")->object->decoder, node("ball")->object->decoder);
  run(R"({"op": "duplicate", "node": "top", "as": "copy"})"
      "\n"
      R"({"op": "transform", "node": "copy", "translate": [0, 3, 0], "rotate": {"axis": [0, 0, 1], "degrees": 90}})"
      "\n"
      R"({"op": "group", "nodes": ["top", "copy"], "as": "both"})"
      "\n"
      R"({"op": "transform", "node": "both", "translate": [0, 0, 7]})"
      "\n"
      R"({"op": "rename", "node": "both", "name": "pair"})");
  const Affine before = find_placed(session.scene(), node("copy")->id)->to_world;
  run(R"({"op": "reorder", "node": "copy", "index": 0, "top": true})");
  EXPECT_EQ(session.scene().roots[0]->name, "copy");
  EXPECT_TRUE(find_placed(session.scene(), node("copy")->id)->to_world.isApprox(before, 1e-14));
  run(R"({"op": "select", "node": "ball", "all": true})"
      "\n"
      R"({"op": "delete"})");
  EXPECT_EQ(node("ball"), nullptr);  // no triangle was left
}

TEST_F(NodeEdits, ScalesAlongRotatedAxes) {
  run(import +
      R"({"op": "transform", "node": "ball", "scale": [1, 3, 1], "scale_axes": {"axis": [0, 0, 1], "degrees": 30}})");
  const Mat3 linear = find_placed(session.scene(), node("ball")->id)->to_world.linear();
  const Vec3 along(-0.5, std::sqrt(3) / 2, 0), across(std::sqrt(3) / 2, 0.5, 0);
  EXPECT_LT((linear * along - 3 * along).norm(), 1e-14);
  EXPECT_LT((linear * across - across).norm(), 1e-14);
}

TEST_F(NodeEdits, PlaceSetsTransformWithoutShear) {
  run(import + R"({"op": "place", "node": "ball", "position": [1, 2, 3], "scale": [2, 1, 0.5]}
{"op": "place", "node": "ball", "rotation": {"axis": [0, 0, 1], "degrees": 30}})");
  const auto place = [&] { return placement_of(node("ball")->to_parent); };
  EXPECT_EQ(place().position, Vec3(1, 2, 3));
  EXPECT_LT((place().scale - Vec3(2, 1, 0.5)).norm(), 1e-15);
  EXPECT_FALSE(place().sheared);
  run(R"({"op": "place", "node": "ball", "scale": [5, 1, 0.5]})");
  const Mat3 turn = Eigen::AngleAxisd(EIGEN_PI / 6, Vec3::UnitZ()).toRotationMatrix();
  EXPECT_LT((node("ball")->to_parent.linear() - turn * Vec3(5, 1, 0.5).asDiagonal()).norm(), 1e-14)
      << "along its own axes";
  // A shear stays when the position changes, and goes when a scale is set.
  run(R"({"op": "transform", "node": "ball", "scale": [1, 3, 1]})");
  EXPECT_TRUE(place().sheared);
  const Mat3 sheared = node("ball")->to_parent.linear();
  run(R"({"op": "place", "node": "ball", "position": [0, 0, 0]})");
  EXPECT_EQ(node("ball")->to_parent.linear(), sheared);
  run(R"({"op": "place", "node": "ball", "scale": [1, 1, 1]})");
  EXPECT_TRUE(node("ball")->to_parent.linear().isUnitary(1e-14));
  // A mirrored node has a placement too.
  run(R"({"op": "place", "node": "ball", "scale": [-2, 1, 1], "rotation": [1, 0, 0, 0]})");
  EXPECT_EQ(Vec3(place().scale), Vec3(-2, 1, 1));
  expect_error(R"({"op": "place", "node": "ball"})", "at least one of position, rotation and scale");
  expect_error(R"({"op": "place", "node": "ball", "scale": 0})", "must not be 0");
}

// What `place` does not set stays, also of mirrored nodes.
TEST_F(NodeEdits, PlaceKeepsTheScaleOrRotationOfMirroredNodes) {
  run(import);
  const auto linear = [&] { return Mat3(node("ball")->to_parent.linear()); };
  for (const char* mirror : {"[1, 1, -1]", "[1, -1, 1]", "[-1, 1, 1]", "-1", "[2, -3, 1]"}) {
    run(fmt::format(R"({{"op": "place", "node": "ball", "scale": {}}}
{{"op": "place", "node": "ball", "scale": [1, 1, 1]}})",
                    mirror));
    EXPECT_LT((linear() - Mat3::Identity()).norm(), 1e-14) << mirror;
  }
  for (const Vec3& mirror : {Vec3(1, 1, -1), Vec3(1, -1, 1), Vec3(-1, 1, 1)})
    for (const double degrees : {30.0, -80.0, 85.0}) {
      run(fmt::format(R"({{"op": "place", "node": "ball", "scale": [{}, {}, {}], "rotation": [1, 0, 0, 0]}}
{{"op": "place", "node": "ball", "rotation": {{"axis": [0.2, 1, 0.1], "degrees": {}}}}})",
                      mirror.x(), mirror.y(), mirror.z(), degrees));
      const Mat3 turn = Eigen::AngleAxisd(degrees * EIGEN_PI / 180, Vec3(0.2, 1, 0.1).normalized()).toRotationMatrix();
      EXPECT_LT((linear() - turn * Mat3(mirror.asDiagonal())).norm(), 1e-14) << mirror << " " << degrees;
      run(R"({"op": "place", "node": "ball", "rotation": [1, 0, 0, 0]})");
      EXPECT_LT((linear() - Mat3(mirror.asDiagonal())).norm(), 1e-14) << mirror << " " << degrees;
    }
}

TEST_F(NodeEdits, DropsOntoObjectsAndGround) {
  // Spheres of radius 1 with holes collide only where they are opaque.
  run(import + R"({"op": "duplicate", "node": "ball", "as": "upper"}
{"op": "place", "node": "ball", "position": [0, 3, 0]}
{"op": "place", "node": "upper", "position": [0.1, 9, 0]}
{"op": "drop", "node": "ball"})");
  const auto low = [&](const char* name) { return subtree_bounds(session.scene(), node(name)->id).min().y(); };
  EXPECT_NEAR(low("ball"), 0, 1e-12) << "on the ground";
  const double before = low("upper");
  run(R"({"op": "drop", "node": "upper"})");
  const double gap = low("upper") - 2;
  EXPECT_LT(low("upper"), before - 4);
  // The centres are 2 apart along a line that leans by 0.1, up to the flat faces of the balls.
  EXPECT_LT(std::abs(gap), 0.15);
  const Scene once = session.scene();
  run(R"({"op": "drop", "node": "upper"})");
  EXPECT_NEAR(low("upper") - 2, gap, 1e-6) << "the node is supported already";
  run(R"({"op": "place", "node": "upper", "position": [50, 9, 0]}
{"op": "drop", "node": "upper", "ground": -2})");
  EXPECT_NEAR(low("upper"), -2, 1e-12);
  run(R"({"op": "drop", "node": "upper", "ground": -1})");
  EXPECT_NEAR(low("upper"), -1, 1e-12) << "a node that intersects the ground is lifted";
  run(R"({"op": "drop", "node": "upper", "ground": 7})");
  EXPECT_NEAR(low("upper"), 7, 1e-12) << "a node below the ground is lifted";
}

TEST_F(NodeEdits, DropLiftsIntersectingNodes) {
  // From random positions inside a ball of radius 1 with its top at y = 2: afterwards the node rests on the ball, not
  // in it.
  run(import + R"({"op": "duplicate", "node": "ball", "as": "upper"}
{"op": "place", "node": "ball", "position": [0, 1, 0]})");
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(-0.9, 0.9);
  for (int k = 0; k < cases(6, 60); ++k) {
    const Vec3 at(any(random), 1 + any(random), any(random));
    run(fmt::format(R"({{"op": "place", "node": "upper", "position": [{}, {}, {}]}})", at.x(), at.y(), at.z()) + "\n" +
        R"({"op": "drop", "node": "upper"})");
    const Vec3 now = find_placed(session.scene(), node("upper")->id)->to_world.translation();
    EXPECT_GE((now - Vec3(0, 1, 0)).norm(), 1.9) << "from " << at.transpose() << " to " << now.transpose();
    EXPECT_NEAR(now.x(), at.x(), 1e-12);
    EXPECT_NEAR(now.z(), at.z(), 1e-12);
    const Scene once = session.scene();
    run(R"({"op": "drop", "node": "upper"})");
    EXPECT_EQ(session.scene().roots, once.roots) << "the node is supported already and must not move";
  }
}

// A box of the given size, centred at the origin.
std::shared_ptr<const BakedObject> box_object(const Vec3& size) {
  auto object = std::make_shared<BakedObject>(*made_object({.columns = 2, .rows = 2}));
  const Soup quad = object->sets[0].soup;
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;
  std::vector<Face> faces;
  const auto add = [&](const std::array<Vec3, 3>& corners) {
    for (std::size_t k = 0; k < 3; ++k) {
      positions.emplace_back(corners[k].cwiseProduct(size) / 2);
      uvs.push_back(quad.uvs()[quad.faces()[0][k]]);
    }
    const auto last = static_cast<std::uint32_t>(positions.size());
    faces.push_back({last - 3, last - 2, last - 1});
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      std::array<Vec3, 4> p;
      for (std::size_t k = 0; k < 4; ++k) {
        p[k][axis] = side;
        p[k][(axis + 1) % 3] = k == 1 || k == 2 ? 1 : -1;
        p[k][(axis + 2) % 3] = k >= 2 ? 1 : -1;
      }
      add({p[0], p[1], p[2]});
      add({p[0], p[2], p[3]});
    }
  object->sets[0].soup = Soup(positions, uvs, faces);
  return object;
}

TEST_F(NodeEdits, DropsCrossedBoxesEdgeToEdge) {
  export_scene(scene_of(box_object({10, 1, 1})), folder_.path() / "beam", {});
  export_scene(scene_of(box_object({1, 1, 10})), folder_.path() / "sleeper", {});
  run(R"({"op": "import", "path": "{here}/sleeper"}
{"op": "ground", "foot": true}
{"op": "import", "path": "{here}/beam"})");
  for (const double y : {7.0, 0.2}) {  // from above, and intersecting the sleeper
    run(fmt::format(R"({{"op": "place", "node": "beam", "position": [0.1, {}, 0.2]}})", y) + "\n" +
        R"({"op": "drop", "node": "beam"})");
    EXPECT_NEAR(find_placed(session.scene(), node("beam")->id)->to_world.translation().y(), 1, 1e-5) << y;
  }
}

// An object of horizontal triangles at these heights; those that are not opaque have opaque texels beside them.
std::shared_ptr<const BakedObject> layers(const std::vector<std::pair<double, bool>>& heights) {
  auto object = std::make_shared<BakedObject>(*made_object());
  constexpr int side = 16;
  const auto texels = std::make_shared<const FeatureTexture>(
      FeatureTexture::from_rows(side, side, AlphaCode::plain, [](int, Texel* row) {
        for (int x = 0; x < side; ++x) row[x] = {{static_cast<std::uint8_t>(x < 8 ? 0 : 255), 9, 9, 9}, {9, 9, 9, 255}};
      }));
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;
  std::vector<Face> faces;
  for (const auto& [height, opaque] : heights) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    const double left = opaque ? 0.55 : 0.1;
    for (const Vec2& corner : {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)}) {
      positions.emplace_back(4 * corner.x() - 1, height, 4 * corner.y() - 1);
      uvs.emplace_back(left + 0.39 * corner.x(), 0.1 + 0.8 * corner.y());
    }
    faces.push_back({first, first + 1, first + 2});
  }
  object->sets = {{Soup(positions, uvs, faces), texels}};
  return object;
}

TEST_F(NodeEdits, DropsThroughTransparentTriangles) {
  export_scene(scene_of(layers({{0, true}, {1, false}})), folder_.path() / "floor", {});
  export_scene(scene_of(layers({{0, true}})), folder_.path() / "body", {});
  run(R"({"op": "import", "path": "{here}/floor"}
{"op": "import", "path": "{here}/body"}
{"op": "place", "node": "body", "position": [0.3, 5, 0.2], "rotation": {"axis": [0, 1, 0], "degrees": 20}}
{"op": "drop", "node": "body"})");
  EXPECT_NEAR(find_placed(session.scene(), node("body")->id)->to_world.translation().y(), 0, 1e-4);
}

TEST_F(NodeEdits, SetsGroundByHeightFootPointsOrSelection) {
  run(import + R"({"op": "ground", "height": -4}
{"op": "drop", "node": "ball"})");
  const auto low = [&] { return subtree_bounds(session.scene(), node("ball")->id).min().y(); };
  EXPECT_NEAR(low(), -4, 1e-12);
  run(R"({"op": "transform", "node": "ball", "translate": [0, 9, 0]}
{"op": "ground", "foot": true})");
  EXPECT_NEAR(session.scene().ground.height, 5, 1e-12);
  EXPECT_EQ(session.scene().ground.normal, Vec3(0, 1, 0));
  // A ball on a slope of 45° touches it at a distance of its radius.
  run(R"({"op": "ground", "points": [[0, 0, 0], [0, 0, 1], [1, 1, 0]]}
{"op": "drop", "node": "ball"})");
  const Ground slope = session.scene().ground;
  EXPECT_NEAR(slope.normal.dot(Vec3(-1, 1, 0).normalized()), 1, 1e-14);
  EXPECT_NEAR(slope.above(find_placed(session.scene(), node("ball")->id)->to_world.translation()), 1, 0.05);
  run(R"({"op": "light", "effects": ["self"], "source": "sky"})");
  EXPECT_EQ(session.scene().light->up, slope.normal) << "sky light comes from above the ground";
  run(R"({"op": "select", "node": "ball", "box": {"min": [0, 0.9, 0], "max": [1, 1, 1]}, "frame": "bounds"}
{"op": "ground", "selection": true})");
  EXPECT_GT(session.scene().ground.normal.y(), 0.9) << "the cap of a ball is level";
  EXPECT_EQ(session.scene().light->up, session.scene().ground.normal);
  run(R"({"op": "import", "path": "{here}/other", "ground": true})");
  EXPECT_EQ(session.scene().ground.normal, Vec3(0, 1, 0));
  EXPECT_EQ(session.scene().light->up, Vec3(0, 1, 0));
  expect_error(R"({"op": "ground"})", "exactly one of");
  expect_error(R"({"op": "ground", "height": 1, "foot": true})", "exactly one of");
  expect_error(R"({"op": "ground", "points": [[0, 0, 0], [1, 1, 1], [2, 2, 2]]})", "collinear");
  expect_error(R"({"op": "ground", "points": [[0, 0, 0], [1, 1, 1]]})", "three points");
}

// The box of a rotated ball is larger than the ball.
TEST_F(NodeEdits, TheLowestPointIsThatOfTrianglesNotOfBoxes) {
  run(import + R"({"op": "transform", "node": "ball", "rotate": {"axis": [0, 0, 1], "degrees": 45}}
{"op": "ground", "foot": true})");
  EXPECT_NEAR(session.scene().ground.height, -1, 0.05);
}

TEST_F(NodeEdits, NodesNamedTwiceDoNotCountTwice) {
  run(import + R"({"op": "import", "path": "{here}/other", "as": "other"}
{"op": "transform", "node": "other", "translate": [5, 1, 0]}
{"op": "group", "nodes": ["ball", "other"], "as": "g"})");
  run(R"({"op": "align", "nodes": ["ball", "other", "other"], "axis": "x", "to": "least"})");
  EXPECT_NEAR(node("other")->to_parent.translation().x(), 0, 1e-12);
  run(R"({"op": "select", "box": {"min": [-9, 0.5, -9], "max": [9, 9, 9]}}
{"op": "ground", "selection": true, "nodes": ["g"]})");
  const Ground once = session.scene().ground;
  run(R"({"op": "ground", "selection": true, "nodes": ["g", "other"]})");
  EXPECT_EQ(session.scene().ground, once);
}

TEST_F(NodeEdits, GroupsWithoutANameDoNotRenameTheirChildren) {
  run(import + R"({"op": "import", "path": "{here}/other", "as": "other"}
{"op": "group", "nodes": ["ball"]}
{"op": "group", "nodes": ["group", "other"]})");
  ASSERT_NE(node("group"), nullptr);
  EXPECT_EQ(node("group")->children.front()->name, "ball");
  EXPECT_EQ(node("group.2")->children.size(), 2U);
}

TEST_F(NodeEdits, DuplicateTranslatesTheCopy) {
  run(import + R"({"op": "transform", "node": "ball", "translate": [1, 0, 0], "scale": 2})"
               "\n"
               R"({"op": "duplicate", "node": "ball", "as": "beside", "translate": [0.25, 0, -3]})");
  EXPECT_EQ(node("beside")->object, node("ball")->object);
  EXPECT_EQ(node("beside")->to_parent.linear(), node("ball")->to_parent.linear());
  EXPECT_EQ(node("beside")->to_parent.translation() - node("ball")->to_parent.translation(), Vec3(0.25, 0, -3));
}

TEST_F(NodeEdits, AlignsAndDistributesNodes) {
  run(import + R"({"op": "duplicate", "node": "ball", "as": "b"}
{"op": "duplicate", "node": "ball", "as": "c"}
{"op": "place", "node": "b", "position": [5, 1, 0], "scale": 2}
{"op": "place", "node": "c", "position": [20, 2, 0]}
{"op": "align", "nodes": ["ball", "b", "c"], "axis": "y", "to": "least"})");
  const auto box = [&](const char* name) { return subtree_bounds(session.scene(), node(name)->id); };
  EXPECT_NEAR(box("b").min().y(), box("ball").min().y(), 1e-12);
  EXPECT_NEAR(box("c").min().y(), box("ball").min().y(), 1e-12);
  const Box first = box("ball"), last = box("c");
  run(R"({"op": "align", "nodes": ["c", "ball", "b"], "to": "spread"})");
  EXPECT_EQ(box("ball").min().x(), first.min().x()) << "the outermost nodes must stay";
  EXPECT_EQ(box("c").max().x(), last.max().x());
  EXPECT_NEAR(box("b").min().x() - box("ball").max().x(), box("c").min().x() - box("b").max().x(), 1e-12);
  expect_error(R"({"op": "align", "nodes": ["ball"]})", "at least two");
  run(R"({"op": "group", "nodes": ["b"], "as": "g"})");
  expect_error(R"({"op": "align", "nodes": ["ball", "g", "b"]})", "must not contain a node and a group above it");
  expect_error(R"({"op": "align", "nodes": ["ball", "b"], "axis": "w"})", "must be x, y or z");
}

// Of the triangles, not of the boxes of rotated objects.
TEST_F(NodeEdits, AlignedAndCentredAreTheTriangles) {
  run(import + R"({"op": "duplicate", "node": "ball", "as": "b"}
{"op": "transform", "node": "b", "rotate": {"axis": [0, 0, 1], "degrees": 40}, "translate": [5, 3, 0]}
{"op": "align", "nodes": ["ball", "b"], "axis": "y", "to": "least"})");
  const auto corners = [&](const char* name) {
    Box box;
    const PlacedNode placed = *find_placed(session.scene(), node(name)->id);
    for (const Vec3& p : placed.node->object->sets[0].soup.positions()) box.extend(placed.to_world * p);
    return box;
  };
  EXPECT_NEAR(corners("b").min().y(), corners("ball").min().y(), 1e-12);
  const Vec3 middle = corners("b").center();
  run(R"({"op": "transform", "node": "b", "scale": 3})");
  EXPECT_LT((corners("b").center() - middle).norm(), 1e-12);
}

TEST_F(NodeEdits, RotatingTrianglesOfAScaledNodeRotatesViewDirections) {
  run(import + R"({"op": "transform", "node": "ball", "scale": [4, 1, 1]})");
  const Mat3 before = find_placed(session.scene(), node("ball")->id)->to_world.linear();
  run(R"({"op": "select", "node": "ball", "all": true})"
      "\n"
      R"({"op": "transform", "node": "ball", "selection": true, "rotate": {"axis": [0, 1, 0], "degrees": 60}})");
  const Mat3 turn = Eigen::AngleAxisd(EIGEN_PI / 3, Vec3::UnitY()).toRotationMatrix();
  const Mat3 wanted = orthogonal_factor(before).transpose() * orthogonal_factor(turn * before);
  for (const PackedRotation& t : *node("ball")->object->sets[0].soup.rotations())
    ASSERT_TRUE(t.matrix().isApprox(wanted, 1e-12));
}

TEST_F(NodeEdits, RejectsOverflowLockedChildrenAndDeepNesting) {
  run(import);
  expect_error(R"({"op": "transform", "node": "ball", "translate": [1.7e308, 0, 0]}
{"op": "transform", "node": "ball", "translate": [1.7e308, 0, 0]})",
               "would be too large");
  run(R"({"op": "group", "nodes": ["ball"], "as": "g"})"
      "\n"
      R"({"op": "lock", "node": "ball"})");
  expect_error(R"({"op": "remove", "node": "g"})", "contains the locked node \"ball\"");
  std::string nested = "{\"op\": ";
  for (int i = 0; i < 5000; ++i) nested += "[";
  expect_error(nested, "nested deeper than 32 levels");
}

// What else a new parent or a lock changes is said.
TEST_F(NodeEdits, NotesSayWhatMovesHidesOrStaysLocked) {
  std::string said;
  session.say = session.report = [&](const std::string& line) { said += line + "\n"; };
  const auto says = [&](const std::string& lines, const std::string& what) {
    said.clear();
    run(lines);
    EXPECT_NE(said.find(what), std::string::npos) << lines << "\n" << said;
  };
  run(import + R"({"op": "duplicate", "node": "ball", "as": "second"}
{"op": "group", "nodes": ["second"], "as": "g"}
{"op": "transform", "node": "g", "rotate": {"axis": [0, 0, 1], "degrees": 45}}
{"op": "key", "time": 0, "node": "g"}
{"op": "key", "time": 1, "node": "g", "position": [1, 0, 0]}
{"op": "key", "time": 0, "node": "ball"}
{"op": "key", "time": 1, "node": "ball", "position": [0, 1, 0]})");
  says(R"({"op": "reorder", "node": "ball", "index": 0, "parent": "g"})", "by the keyframes of \"g\" from now on");
  EXPECT_NE(said.find("may move along another path"), std::string::npos) << said;
  says(R"({"op": "reorder", "node": "ball", "index": 0, "top": true})", "no longer move \"ball\"");
  run(R"({"op": "hide", "node": "g"})");
  says(R"({"op": "reorder", "node": "ball", "index": 0, "parent": "g"})", "\"ball\" is hidden from now on");
  run(R"({"op": "lock", "node": "ball"})");
  says(R"({"op": "set_length", "points": [[0, 0, 0], [1, 0, 0]], "length": 2})", "moves \"ball\" too, which is locked");
  says(R"({"op": "key", "time": 2, "node": "g", "position": [2, 0, 0]})", "moves \"ball\" too, which is locked");
}

TEST_F(NodeEdits, LeavingAHiddenGroupStaysHidden) {
  run(import + R"({"op": "group", "nodes": ["ball"], "as": "g"})"
               "\n"
               R"({"op": "hide", "node": "g"})"
               "\n"
               R"({"op": "reorder", "node": "ball", "index": 0, "top": true})");
  EXPECT_FALSE(find_placed(session.scene(), node("ball")->id)->visible);
}

TEST_F(NodeEdits, MergeReportsMismatches) {
  run(import + R"({"op": "import", "path": "{here}/other", "as": "other"}
{"op": "duplicate", "node": "ball", "as": "second"}
{"op": "transform", "node": "second", "translate": [3, 0, 0]}
{"op": "merge", "nodes": ["ball", "second"]})");
  EXPECT_EQ(node("ball")->object->triangle_count(), 512U);
  EXPECT_EQ(node("second"), nullptr);
  EXPECT_NEAR(node("ball")->object->bounds().max().x(), 4, 1e-9);
  expect_error(R"({"op": "merge", "nodes": ["ball", "other"]})", "different decoders or axes");
  expect_error(R"({"op": "merge", "nodes": ["ball", "ball"]})", "named twice");
  expect_error(R"({"op": "merge", "nodes": ["ball"]})", "at least two");
}

}  // namespace
}  // namespace rebake::test
