// Degenerate scenes and extreme fields must not crash the program or give wrong pictures without a message.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "editor/actions/session.h"
#include "editor/actions/views.h"
#include "editor/script/script.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/deform/cages/cage_mesh.h"
#include "mesh_ops/formats/export.h"
#include "render/compare.h"
#include "render/picture.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

class Robustness : public ::testing::Test {
 protected:
  void run(const std::string& text) { run_script(session, text, "s.jsonl", {{"here", folder.path().string()}}); }
  std::string error_of(const std::string& text) {
    try {
      run(text);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  void import_object(const BakedObject& object, const std::string& name) {
    export_scene(scene_of(std::make_shared<BakedObject>(object)), folder.path() / name, {});
    run(R"({"op": "import", "path": "{here}/)" + name + R"(", "as": ")" + name + R"("})");
  }
  Image picture() {
    View view;
    view.width = view.height = 160;
    view.camera.eye = {0.4, 0.7, 4};
    view.camera.near_plane = 0.1;
    return session.renderer().render(session.scene(), view);
  }

  Session session;
  TemporaryFolder folder;
};

TEST_F(Robustness, RejectsWrapOfDegenerateTriangles) {
  BakedObject object = *made_object({.columns = 4, .rows = 2, .holes = false});
  for (TextureSet& set : object.sets) {
    std::vector<Vec3> positions = set.soup.positions();
    for (Vec3& p : positions) p = {p.x(), 0, 0};
    set.soup = Soup(positions, set.soup.uvs(), set.soup.faces());
  }
  import_object(object, "lines");
  const Scene before = session.scene();
  for (const char* line :
       {R"({"op": "cage", "node": "lines", "wrap": 0.1, "moves": [{"points": [0], "translate": [0, 1, 0]}]})",
        R"({"op": "handles", "node": "lines", "moves": [{"points": [0], "translate": [0, 1, 0]}]})"})
    EXPECT_NE(error_of(line).find("no triangle has an area"), std::string::npos) << error_of(line);
  EXPECT_EQ(session.scene().roots, before.roots);
}

TEST_F(Robustness, ExtremeEyesAndScalesSelectOrFail) {
  import_object(*made_object({.columns = 8, .rows = 4}), "ball");
  const std::string select =
      R"({"op": "select_picture", "polygon": [[0, 0], [200, 0], [200, 200], [0, 200]], "size": [200, 200], "camera": {"eye": )";
  for (const char* eye : {"[0, 0, 1e19]", "[1e300, 0, 0]", "[0, 0, 4]"})
    error_of(select + eye + R"(, "target": [0, 0, 0], "near": 1e-3, "far": 1e30}})");
  for (const char* scale : {"1e-19", "1e19", "1"}) {
    run(R"({"op": "transform", "node": "ball", "scale": )" + std::string(scale) + "}");
    error_of(select + R"([0, 0, 4], "target": [0, 0, 0]}})");
    run(R"({"op": "undo"})");
  }
  run(select + R"([0, 0, 4], "target": [0, 0, 0]}})");
  EXPECT_NE(find(session.scene(), "ball")->selection, nullptr);
}

// Each texture has its own alpha code: one code for all would give wrong colours (39.9 dB).
TEST_F(Robustness, MergingDifferentAlphaCodesKeepsThePicture) {
  import_object(*made_object({.columns = 16, .rows = 8, .code = AlphaCode::halved}), "a");
  import_object(*made_object({.columns = 16, .rows = 8, .code = AlphaCode::plain, .layout = Layout::unsplit}), "b");
  ASSERT_NE(find(session.scene(), "a")->object->sets[0].texels->alpha_code(),
            find(session.scene(), "b")->object->sets[0].texels->alpha_code());
  run(R"({"op": "transform", "node": "b", "translate": [0.8, 0.3, 0.2]})");
  const Image before = picture();
  run(R"({"op": "merge", "nodes": ["a", "b"]})");
  EXPECT_GE(compare(picture(), before, 2).psnr_db, 48);
  EXPECT_LE(compare(picture(), before, 2).share_beyond, 0.002);
}

TEST_F(Robustness, EmptyPicturesHaveAReason) {
  import_object(*made_object({.columns = 8, .rows = 4}), "ball");
  View view;
  view.width = view.height = 64;
  const auto why = [&] {
    return blank_reason(session.scene(), view, session.renderer().render(session.scene(), view))
        .value_or("it shows something");
  };
  view.camera.eye = {0, 0, 4};
  EXPECT_EQ(why(), "it shows something");
  const Image red{1, 2, {255, 0, 0, 255, 0, 0}};
  EXPECT_EQ(blank_reason(session.scene(), view, red), std::nullopt) << "an object fills it with one colour";
  view.camera.far_plane = 2;
  EXPECT_NE(why().find("beyond the far plane at 2"), std::string::npos) << why();
  view.camera.far_plane = 1000;
  view.camera.near_plane = 100;
  EXPECT_NE(why().find("before the near plane at 100"), std::string::npos) << why();
  view.camera.near_plane = 0.1;
  view.camera.target = {0, 0, 8};
  EXPECT_NE(why().find("behind the camera"), std::string::npos) << why();
  view.camera.target = {4, 0, 4};
  view.camera.near_plane = 2;
  EXPECT_NE(why().find("outside the field of view"), std::string::npos)
      << "planes that clip nothing must not be named: " << why();
  view.camera.near_plane = 0.1;
  view.camera.far_plane = 1e6;
  view.camera.eye = {0, 0, 1e5};
  view.camera.target = {0, 0, 0};
  EXPECT_NE(why().find("smaller than a pixel"), std::string::npos) << why();
  view.camera.eye = {0, 0, 4};
  run(R"({"op": "hide", "node": "ball"})");
  EXPECT_NE(why().find("hidden"), std::string::npos) << why();
}

TEST(CageRods, AcceptsThinRodsRejectsFlatCages) {
  for (const double thin : {5e-8, 1e-10})
    EXPECT_NO_THROW(checked_cage(lattice_cage(Box(Vec3(0, 0, 0), Vec3(1, thin, thin)), 2, 1, 1))) << thin;
  Cage flat = lattice_cage(Box(Vec3(0, 0, 0), Vec3(1, 1, 1)), 2, 2, 1);
  for (Vec3& v : flat.vertices) v.z() = 0.3 * v.x() + 0.1 * v.y();
  EXPECT_THROW(checked_cage(flat), Error);
}

}  // namespace
}  // namespace rebake::test
