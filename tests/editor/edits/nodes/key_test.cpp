// Keyframes as edits: of places, bends and the camera.
#include "editor/edits/nodes/key.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mesh_ops/formats/formats.h"
#include "mesh_ops/motion/scene_at.h"
#include "tests/support/made_scenes.h"
#include "tests/support/script_fixture.h"

namespace rebake::test {
namespace {

class KeyTest : public Script {
 protected:
  Scene at(double seconds) const { return scene_at(session.scene(), seconds); }
  Vec3 place(double seconds) const { return find(at(seconds), "ball")->to_parent.translation(); }
  std::vector<Vec3> points(const Scene& scene) const { return find(scene, "ball")->object->sets[0].soup.positions(); }
};

TEST_F(KeyTest, MovesANodeWithoutTouchingItsOwnPlace) {
  run(import + R"({"op": "key", "node": "ball", "time": 0, "interpolation": "linear"}
{"op": "key", "node": "ball", "time": 2, "position": [4, 0, 0]})");
  EXPECT_EQ(place(1), Vec3(2, 0, 0));
  EXPECT_EQ(node("ball")->to_parent.translation(), Vec3(0, 0, 0));
  EXPECT_EQ(duration(session.scene()), 2);
  run(R"({"op": "undo"})");
  EXPECT_EQ(place(2), Vec3(0, 0, 0));
  run(R"({"op": "key", "node": "ball", "time": 0, "remove": true})");
  EXPECT_EQ(node("ball")->motion, nullptr);
}

TEST_F(KeyTest, BendsAsTheEditBendDoes) {
  const std::string region = R"("box": {"min": [0, 0.5, 0], "max": [1, 1, 1]}, "frame": "bounds", "falloff": 0.3)";
  run(import + R"({"op": "key", "node": "ball", "time": 0, "degrees": 0, )" + region + "}\n" +
      R"({"op": "key", "node": "ball", "time": 1, "degrees": 50, "interpolation": "linear"})"
      "\n"
      R"({"op": "key", "node": "ball", "time": 3, "degrees": -50})");
  const Scene bent = at(1), half = at(1.5), straight = at(2);
  EXPECT_EQ(find(at(0), "ball")->object, node("ball")->object);  // no work without a bend
  EXPECT_EQ(points(straight), points(session.scene()));
  run(fmt::format(R"({{"op": "bend", "node": "ball", "degrees": 50, {}}})", region));
  EXPECT_EQ(points(bent), points(session.scene()));
  run(
      fmt::format("{{\"op\": \"undo\"}}\n"
                  R"({{"op": "bend", "node": "ball", "degrees": 25, {}}})",
                  region));
  EXPECT_EQ(points(half), points(session.scene()));
}

TEST_F(KeyTest, BendsAStoredSelectionAfterTrianglesWereDeleted) {
  run(import + R"({"op": "select", "node": "ball", "half_space": {"point": [0, 0, 0], "normal": [0, 1, 0]}}
{"op": "store_selection", "name": "top"}
{"op": "key", "node": "ball", "time": 1, "degrees": 30, "selection": "top", "track": "nod"}
{"op": "select", "node": "ball", "box": {"min": [-9, -9, -9], "max": [9, -0.8, 9]}}
{"op": "delete"})");
  const auto object = find(at(1), "ball")->object;
  ASSERT_NE(object, nullptr);
  EXPECT_LT(object->triangle_count(), 256U);
  EXPECT_NE(object->sets[0].soup.positions(), node("ball")->object->sets[0].soup.positions());
}

TEST_F(KeyTest, TheCameraHasKeyframesOfItsOwn) {
  run(import + R"({"op": "view", "name": "front", "camera": {"eye": [0, 0, 5], "target": [0, 0, 0]}}
{"op": "key", "time": 0, "view": "front"}
{"op": "key", "time": 1, "camera": {"eye": [5, 0, 0], "target": [0, 0, 0]}})");
  ASSERT_EQ(session.scene().camera_keys.size(), 2U);
  EXPECT_NEAR(value_at(session.scene().camera_keys, 0.5).eye.norm(), 5, 1e-12);
  run(R"({"op": "key", "time": 1, "remove": true})");
  EXPECT_EQ(session.scene().camera_keys.size(), 1U);
}

TEST_F(KeyTest, ScenesAndProjectsKeepKeyframes) {
  const std::string scene = (folder_.path() / "scene").string(), project = (folder_.path() / "p.rebake").string();
  run(import + R"({"op": "key", "node": "ball", "time": 0.5, "position": [1, 2, 3], "interpolation": "step"}
{"op": "key", "node": "ball", "time": 1, "degrees": 20, "box": {"min": [-2, 0, -2], "max": [2, 2, 2]}, "axis": [0, 1, 0.1]}
{"op": "key", "time": 1, "camera": {"eye": [5, 0, 0], "target": [0, 0, 0]}})");
  const NodeMotion motion = *node("ball")->motion;
  const Keyframes<Camera> camera = session.scene().camera_keys;
  run(fmt::format("{{\"op\": \"save\", \"out\": \"{}\"}}\n{{\"op\": \"save_project\", \"out\": \"{}\"}}", scene,
                  project));
  const Scene read = read_any(scene, {});
  ASSERT_NE(find(read, "ball")->motion, nullptr);
  EXPECT_EQ(*find(read, "ball")->motion, motion);
  EXPECT_EQ(read.camera_keys, camera);
  const Document opened = Document::open(project);
  EXPECT_EQ(*find(opened.scene(), "ball")->motion, motion);
  EXPECT_EQ(opened.scene().camera_keys, camera);
}

TEST_F(KeyTest, KeyframesMoveWithTheirNodeThroughTheTree) {
  run(import + R"({"op": "key", "node": "ball", "time": 0, "interpolation": "linear"}
{"op": "key", "node": "ball", "time": 2, "position": [4, 0, 0]}
{"op": "group", "nodes": ["ball"], "as": "all"}
{"op": "transform", "node": "all", "translate": [0, 5, 0]})");
  const auto world = [&](const std::string& name) {
    const Scene moved = at(2);
    return Vec3(find_placed(moved, find(moved, name)->id)->to_world.translation());
  };
  EXPECT_EQ(world("ball"), Vec3(4, 5, 0));
  run(R"({"op": "reorder", "node": "ball", "index": 0, "top": true})");
  EXPECT_EQ(world("ball"), Vec3(4, 5, 0));
  run(R"({"op": "duplicate", "node": "ball", "as": "copy", "translate": [0, 0, 3]})");
  EXPECT_EQ(world("copy"), Vec3(4, 5, 3));
  run(R"({"op": "transform", "node": "all", "translate": [0, 1, 0]}
{"op": "group", "nodes": ["copy"], "as": "more"})");
  EXPECT_EQ(world("copy"), Vec3(4, 5, 3));
}

TEST_F(KeyTest, PartsOutsideOfABendStay) {
  run(import + R"({"op": "key", "node": "ball", "time": 1, "degrees": 40, "box": {"min": [-2, 0, -2], "max": [2, 2, 2]}}
{"op": "select", "node": "ball", "box": {"min": [-2, -2, -2], "max": [2, -0.3, 2]}}
{"op": "separate", "node": "ball", "as": "foot"})");
  EXPECT_EQ(find(at(1), "foot")->object, node("foot")->object);
  EXPECT_NE(find(at(1), "ball")->object, node("ball")->object);
  run(R"({"op": "key", "node": "foot", "time": 2, "position": [1, 0, 0]})");
  expect_error(R"({"op": "merge", "nodes": ["ball", "foot"]})", "different keyframes");
}

TEST_F(KeyTest, SaysWhatIsWrong) {
  run(import);
  expect_error(R"({"op": "key", "time": 1})", "give a node, or a camera or view");
  expect_error(R"({"op": "key", "time": -1, "node": "ball"})", "must lie between 0 and 86400 s");
  expect_error(R"({"op": "key", "time": 1, "degrees": 5})", "name the node that bends");
  expect_error(R"({"op": "key", "time": 1, "node": "ball", "degrees": 5, "position": [0, 0, 0]})",
               "one key edit for each");
  expect_error(R"({"op": "key", "time": 1, "node": "ball", "degrees": 5, "selection": "tip"})",
               "stored selection \"tip\"");
  expect_error(R"({"op": "key", "time": 1, "node": "ball", "remove": true})", "no such keyframe at 1 s");
  expect_error(R"({"op": "key", "time": 1, "view": "x"})", "there is no view");
  expect_error(R"({"op": "key", "time": 1, "node": "ball", "falloff": 0.2})", "describe a bend");
  expect_error(R"({"op": "key", "time": 1, "node": "ball", "degrees": 5, "box": {"min": [5, 5, 5], "max": [6, 6, 6]}})",
               "no triangle is inside");
}

TEST_F(KeyTest, SaysThatAStoredSelectionOfABendHasChanged) {
  std::string said;
  session.say = [&](const std::string& line) { said += line + "\n"; };
  run(import + R"({"op": "select", "node": "ball", "half_space": {"point": [0, 0, 0], "normal": [0, 1, 0]}}
{"op": "store_selection", "name": "top"}
{"op": "key", "node": "ball", "time": 1, "degrees": 30, "selection": "top", "track": "nod"}
{"op": "store_selection", "name": "top"})");
  EXPECT_EQ(said.find("nod"), said.rfind("nod")) << "only the key itself: " << said;
  run(R"({"op": "select", "node": "ball", "half_space": {"point": [0, 0.5, 0], "normal": [0, 1, 0]}}
{"op": "store_selection", "name": "top"})");
  EXPECT_NE(said.find("now moves the triangles of the stored selection \"top\""), std::string::npos) << said;
}

TEST_F(KeyTest, SaysThatNodesHaveLeftAMovingGroup) {
  std::string said;
  session.say = [&](const std::string& line) { said += line + "\n"; };
  run(import + R"({"op": "group", "nodes": ["ball"], "as": "g"}
{"op": "key", "node": "g", "time": 1, "position": [1, 0, 0]})");
  EXPECT_EQ(said.find("no longer move"), std::string::npos) << said;
  run(R"({"op": "reorder", "node": "ball", "index": 0, "top": true})");
  EXPECT_NE(said.find("films no longer move \"ball\""), std::string::npos) << said;
}

}  // namespace
}  // namespace rebake::test
