// What several scenes bring along besides their nodes: background, ground, light and views.
#include <gtest/gtest.h>

#include "tests/support/script_fixture.h"

namespace rebake::test {
namespace {

class SeveralScenes : public Script {
 protected:
  SeveralScenes() {
    Session other;
    run_script(other, import + R"({"op": "ground", "height": -1}
{"op": "background", "color": [0, 0, 1]}
{"op": "view", "name": "front", "camera": {"eye": [9, 0, 0], "target": [0, 0, 0]}}
{"op": "save", "out": "{here}/scene"})",
               "other.jsonl", {{"here", folder_.path().string()}});
    session.say = [this](const std::string& line) { said_ += line + "\n"; };
  }
  std::string said_;
};

TEST_F(SeveralScenes, EditsBeforeTheFirstImportAreKept) {
  run(R"({"op": "ground", "height": -5}
{"op": "background", "color": [1, 0, 0]}
{"op": "import", "path": "{here}/scene"})");
  EXPECT_EQ(session.scene().ground.height, -5);
  EXPECT_EQ(session.scene().background, Color(1, 0, 0));
  EXPECT_NE(said_.find("not imported, because the scene has its own: its background, its ground"), std::string::npos)
      << said_;
}

TEST_F(SeveralScenes, TheFirstImportSetsThem) {
  run(R"({"op": "import", "path": "{here}/scene"})");
  EXPECT_EQ(session.scene().ground.height, -1);
  EXPECT_EQ(session.scene().background, Color(0, 0, 1));
  EXPECT_EQ(said_.find("not imported"), std::string::npos) << said_;
}

TEST_F(SeveralScenes, LaterImportsReportWhatTheyDrop) {
  run(import + R"({"op": "view", "name": "front", "camera": {"eye": [0, 0, 9], "target": [0, 0, 0]}}
{"op": "import", "path": "{here}/scene"})");
  EXPECT_EQ(session.scene().views.at("front").eye, Vec3(0, 0, 9));
  EXPECT_NE(said_.find("the view \"front\", its background, its ground"), std::string::npos) << said_;
}

TEST_F(SeveralScenes, ExportsReportWhatTheFormatDrops) {
  run(R"({"op": "import", "path": "{here}/scene"}
{"op": "export", "out": "{here}/out"})");
  EXPECT_NE(said_.find("the format has no ground"), std::string::npos) << said_;
}

TEST_F(Script, SingleCarriageReturnsEndLines) {
  run("# a comment\r" + import.substr(0, import.size() - 1) + "\r" +
      R"({"op": "select", "all": true})"
      "\r\n");
  EXPECT_EQ(selected("ball"), node("ball")->object->triangle_count());
}

}  // namespace
}  // namespace rebake::test
