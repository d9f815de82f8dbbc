// The edit refit: reads photographs, can be undone, and notices changed ones.
#include "editor/edits/shape/refit.h"

#include <gtest/gtest.h>

#include "mesh_ops/base/files.h"
#include "mesh_ops/refit/texel_observations.h"
#include "render/image.h"
#include "tests/support/made_scenes.h"
#include "tests/support/script_fixture.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

class RefitTest : public Script {
 protected:
  RefitTest() {
    fs::create_directories(at("cap"));
    run(import + R"({"op": "view", "name": "a", "camera": {"eye": [0, 0, 5], "target": [0, 0, 0]}}
{"op": "view", "name": "b", "camera": {"eye": [3, 1, 4], "target": [0, 0, 0]}}
{"op": "export_views", "out": "{here}/cap/transforms.json", "width": 96, "height": 96}
{"op": "render", "view": "a", "out": "{here}/cap/a.png", "width": 96, "height": 96}
{"op": "render", "view": "b", "out": "{here}/cap/b.png", "width": 96, "height": 96})");
  }
  fs::path at(const std::string& name) const { return folder_.path() / name; }
  const std::string refit_ = R"({"op": "refit", "path": "{here}/cap/transforms.json"})";
};

TEST_F(RefitTest, ChangesFeaturesAndIsUndone) {
  const auto before = node("ball")->object;
  std::string said;
  session.say = [&](const std::string& line) { said += line; };
  run(refit_);
  EXPECT_NE(said.find("texels to 2 photographs: root mean square error"), std::string::npos) << said;
  EXPECT_NE(said.find("are in no photograph (colours kept)"), std::string::npos) << said;
  EXPECT_NE(node("ball")->object, before);
  EXPECT_EQ(node("ball")->object->sets[0].soup.shared_positions(), before->sets[0].soup.shared_positions());
  run(R"({"op": "undo"})");
  EXPECT_EQ(node("ball")->object, before);
}

TEST_F(RefitTest, ProjectsNoticeOtherPhotographs) {
  run(refit_ + R"(
{"op": "save_project", "out": "{here}/p.rebake"})");
  const auto fitted = folder_bytes(at("cap"));
  Document opened = Document::open(at("p.rebake"), {}, {});
  EXPECT_EQ(opened.scene().roots.front()->object->sets[0].texels->memory(),
            node("ball")->object->sets[0].texels->memory());
  Image other = read_image(at("cap/a.png"));
  other.rgb[0] ^= 255;
  fs::remove(at("cap/a.png"));
  write_picture(other, at("cap/a.png"), {});
  EXPECT_THROW(Document::open(at("p.rebake"), {}, {}), Error);
  EXPECT_FALSE(session.document.save(at("p.rebake")).opens);
  // Outputs do not replace photographs that undo and projects read again.
  expect_error(R"({"op": "render", "out": "{here}/cap/b.png", "width": 8, "height": 8})", "a file that this run reads");
}

TEST_F(RefitTest, NodesWithOneObjectChangeOnlyTheirOwnSelection) {
  run(R"({"op": "duplicate", "node": "ball", "as": "copy"}
{"op": "select", "node": "ball", "half_space": {"point": [0, 0, 0], "normal": [1, 0, 0]}}
{"op": "select", "node": "copy", "half_space": {"point": [0, 0, 0], "normal": [-1, 0, 0]}})");
  const auto before = node("ball")->object;
  ASSERT_EQ(node("copy")->object, before);
  ASSERT_GT(selected("ball"), 0U);
  run(refit_.substr(0, refit_.size() - 1) + R"(, "selection": true})");
  // Texels outside a node's own selection are those of before.
  for (const char* name : {"ball", "copy"}) {
    const BakedObject& after = *node(name)->object;
    std::size_t changed = 0;
    for (const ObservedTexel& texel : observed_texels(*before, *node(name)->selection)) {
      const TexelReader was(*before->sets[texel.set].texels), is(*after.sets[texel.set].texels);
      const int x = static_cast<int>(texel.x), y = static_cast<int>(texel.y);
      const bool differs = !(was.at(x, y) == is.at(x, y));
      changed += differs ? 1 : 0;
      ASSERT_TRUE(texel.chosen || !differs) << name;
    }
    EXPECT_GT(changed, 50U) << name;
  }
}

TEST_F(RefitTest, SaysWhatIsWrong) {
  expect_error(R"({"op": "refit", "path": ""})", "is empty");
  expect_error(R"({"op": "refit", "path": "{here}/cap/transforms.json", "epochs": 0})", "epochs");
  expect_error(R"({"op": "refit", "path": "{here}/cap/transforms.json", "selection": true})",
               "no triangle is selected");
  run(R"({"op": "transform", "node": "ball", "translate": [100, 0, 0]})");
  expect_error(refit_, "the photographs see none of these texels");
  fs::remove(at("cap/a.png"));
  fs::remove(at("cap/b.png"));
  expect_error(refit_, "none of its photographs exists");
}

}  // namespace
}  // namespace rebake::test
