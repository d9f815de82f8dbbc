// Deforming edits in scripts: results, messages, pictures and files.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <atomic>
#include <numbers>

#include "editor/actions/session.h"
#include "editor/edits/deform/deforming.h"
#include "editor/script/script.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/deform/bends/closed_form.h"
#include "mesh_ops/deform/cage_coordinates/coordinates.h"
#include "mesh_ops/deform/cages/cage_mesh.h"
#include "mesh_ops/formats/export.h"
#include "render/compare.h"
#include "render/graph/plan.h"
#include "render/picture.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

class DeformScript : public ::testing::Test {
 protected:
  DeformScript() {
    session.say = [this](const std::string& line) { said += line + "\n"; };
    export_scene(scene_of(made_object({.columns = 32, .rows = 16})), folder_.path() / "ball", {});
    run(R"({"op": "import", "path": "{here}/ball", "as": "ball"})");
  }
  void run(const std::string& text) { run_script(session, text, "s.jsonl", {{"here", folder_.path().string()}}); }
  void expect_error(const std::string& text, const std::string& says) {
    const Scene before = session.scene();
    try {
      run(text);
      ADD_FAILURE() << "was done: " << text;
    } catch (const ScriptError& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
    EXPECT_EQ(session.scene().roots, before.roots) << "a failed edit must not change the scene";
  }
  Image picture() {
    View view;
    view.width = view.height = 200;
    view.camera.eye = {0.4, 0.7, 4};
    view.camera.near_plane = 0.1;
    return session.renderer().render(session.scene(), view);
  }
  const BakedObject& ball() const { return *find(session.scene(), "ball")->object; }

  Session session;
  std::string said;
  TemporaryFolder folder_;
};

// Each stage of a deformation reports its progress and can be cancelled; the scene is then unchanged.
TEST_F(DeformScript, LongDeformationsReportProgressAndCancel) {
  const Scene before = session.scene();
  const std::string moves = R"("moves": [{"points": [0], "translate": [0.1, 0, 0]}]})";
  for (const auto& [stage, line] :
       {std::pair("wrap", R"("wrap": 0.05, )"), std::pair("cage weights", R"("wrap": 0.3, )"),
        std::pair("harmonic", R"("wrap": 0.3, "coordinates": "harmonic", )")}) {
    std::atomic<bool> stop = false;
    session.progress = Progress(
        [&, name = std::string(stage)](std::string_view what, double share) {
          EXPECT_GE(share, 0);
          EXPECT_LE(share, 1);
          if (what.find(name) != std::string_view::npos) stop = true;
        },
        &stop);
    EXPECT_THROW(run(R"({"op": "cage", "node": "ball", )" + std::string(line) + moves), Cancelled) << stage;
    EXPECT_EQ(session.scene().roots, before.roots);
  }
}

// While the window's tool holds the coordinates of a drag, the committed edit reuses them, with the same result.
TEST_F(DeformScript, CageEditReusesHeldHarmonicCoordinates) {
  const std::string line =
      R"({"op": "cage", "node": "ball", "lattice": [2, 2, 2], "coordinates": "harmonic", "resolution": 16, )"
      R"("moves": [{"points": [0, 1], "translate": [0.3, 0, 0.1]}]})";
  bool solved = false;
  session.progress = Progress([&](std::string_view what, double) { solved |= what == "harmonic coordinates"; });
  run(line);
  EXPECT_TRUE(solved);
  const std::vector<Vec3> moved = ball().sets[0].soup.positions();
  run(R"({"op": "undo"})");
  DeformTarget target;
  target.node = NodeRef{find(session.scene(), "ball")->id};
  CageSource source;
  source.lattice = {2, 2, 2};
  const auto held =
      shared_coordinates(cage_of(source, deform_set(session.scene(), target)), CageCoordinates::harmonic, 16);
  solved = false;
  run(line);
  EXPECT_FALSE(solved);
  EXPECT_EQ(ball().sets[0].soup.positions(), moved);
}

TEST_F(DeformScript, RigidCageMotionMatchesNodeMotion) {
  const char* const moves =
      R"("moves": [{"box": {"min": [-9, -9, -9], "max": [9, 9, 9]}, "translate": [0.2, 0.1, -0.3], )"
      R"("rotate": {"axis": [1, 2, 0.5], "degrees": 70}, "pivot": [0, 0, 0]}]})";
  run(R"({"op": "transform", "node": "ball", "translate": [0.2, 0.1, -0.3], "rotate": {"axis": [1, 2, 0.5], "degrees": 70}, "pivot": [0, 0, 0]})");
  const Image by_node = picture();
  run(R"({"op": "undo"})");
  const Image before = picture();
  EXPECT_LT(compare(by_node, before, 2).psnr_db, 30) << "the motion must change the picture";
  for (const char* cage :
       {R"("lattice": [2, 2, 2])", R"("wrap": 0.2)", R"("lattice": [1, 1, 1], "coordinates": "green")",
        R"("wrap": 0.2, "coordinates": "harmonic", "resolution": 16)"}) {
    run(R"({"op": "cage", "node": "ball", )" + std::string(cage) + ", " + moves);
    EXPECT_GE(compare(picture(), by_node, 2).psnr_db, 48) << cage;
    run(R"({"op": "undo"})");
    EXPECT_TRUE(picture().rgb == before.rgb) << "undo restores every bit";
  }
}

// All points of a box that is its own cage lie on faces, edges and corners of the cage, where gradients are one-sided
// limits.
TEST_F(DeformScript, BoxRotatedByItsOwnCageMatchesRotatedNode) {
  const Cage cells = lattice_cage(Box(Vec3(-0.75, -0.875, -0.625), Vec3(0.75, 0.875, 0.625)), 4, 4, 4);
  std::string text = "mtllib shape0.mtl\n";
  std::vector<Vec2> uvs;
  for (const Vec3& v : cells.vertices) text += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
  BakedObject box = ball();
  std::vector<Vec3> positions;
  std::vector<Face> faces;
  for (const Face& face : cells.faces) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (std::size_t k = 0; k < 3; ++k) {
      positions.push_back(cells.vertices[face[k]]);
      uvs.emplace_back(0.05 + 0.1 * static_cast<double>(k == 1), 0.05 + 0.1 * static_cast<double>(k == 2));
    }
    faces.push_back({first, first + 1, first + 2});
  }
  box.sets = {box.sets[0]};
  box.sets[0].soup = Soup(positions, uvs, faces);
  export_scene(scene_of(std::make_shared<BakedObject>(box)), folder_.path() / "box", {});
  run(R"({"op": "import", "path": "{here}/box", "as": "box"})"
      "\n"
      R"({"op": "hide", "node": "ball"})");
  run(R"({"op": "transform", "node": "box", "rotate": {"axis": [0, 1, 0], "degrees": 180}, "pivot": [0, 0, 0]})");
  const Image by_node = picture();
  run(R"({"op": "undo"})");
  write_text(folder_.path() / "own.obj", [&] {
    std::string obj;
    const Cage own = lattice_cage(Box(Vec3(-0.75, -0.875, -0.625), Vec3(0.75, 0.875, 0.625)), 1, 1, 1);
    for (const Vec3& v : own.vertices) obj += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
    for (const Face& f : own.faces) obj += fmt::format("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
    return obj;
  }());
  for (const char* coordinates : {"mean_value", "green"}) {
    said.clear();
    run(fmt::format(
        R"({{"op": "cage", "node": "box", "mesh": "{}", "coordinates": "{}", "moves": [{{"box": {{"min": [-9, -9, -9], "max": [9, 9, 9]}}, "rotate": {{"axis": [0, 1, 0], "degrees": 180}}, "pivot": [0, 0, 0]}}]}})",
        (folder_.path() / "own.obj").string(), coordinates));
    EXPECT_EQ(said.find("fold"), std::string::npos) << said;
    EXPECT_LE(compare(picture(), by_node, 2).largest, 2) << coordinates;
    run(R"({"op": "undo"})");
  }
}

TEST_F(DeformScript, PlanRotatesRaysOnlyForBentObjects) {
  View view;
  view.camera.eye = {0, 0, 4};
  const std::string before = describe(plan(session.scene(), view).passes);
  run(R"({"op": "twist", "node": "ball", "degrees": 90})");
  EXPECT_NE(describe(plan(session.scene(), view).passes), before);
  run(R"({"op": "undo"})");
  EXPECT_EQ(describe(plan(session.scene(), view).passes), before);
}

TEST_F(DeformScript, EveryDeformationRunsAsOneLine) {
  for (
      const char* line :
      {R"({"op": "bend", "node": "ball", "degrees": 40})",
       R"({"op": "bend", "node": "ball", "degrees": 40, "direction": [0, 0, 1], "from": 0.5, "to": 1.5})",
       R"({"op": "bend", "node": "ball", "degrees": 40, "spine": [[0, -1, 0], [0.2, 0, 0], [0, 1, 0.1]], "from": 0.3})",
       R"({"op": "twist", "node": "ball", "degrees": 90, "axis": [1, 0, 0]})",
       R"({"op": "taper", "node": "ball", "factor": 0.5})", R"({"op": "stretch", "node": "ball", "factor": 2})",
       R"({"op": "bend", "node": "ball", "degrees": 40, "box": {"min": [0, 0.5, 0], "max": [1, 1, 1]}, "frame": "bounds", "falloff": 0.3})",
       R"({"op": "cage", "node": "ball", "moves": [{"points": [0, [3, 5]], "translate": [0.1, 0, 0]}]})",
       R"({"op": "handles", "node": "ball", "wrap": 0.2, "frame": "bounds", "fixed": [{"box": {"min": [0, 0, 0], "max": [1, 0.2, 1]}}], "moves": [{"sphere": {"center": [0.5, 1, 0.5], "radius": 0.2}, "translate": [0.5, 0, 0]}]})"}) {
    const auto before = find(session.scene(), "ball")->object;
    said.clear();
    run(line);
    EXPECT_NE(find(session.scene(), "ball")->object, before) << line;
    EXPECT_NE(said.find("deformed, minimum det J"), std::string::npos) << said;
    run(R"({"op": "undo"})");
    EXPECT_EQ(find(session.scene(), "ball")->object, before);
  }
}

TEST_F(DeformScript, FoldsAreReportedAndSelectable) {
  run(R"({"op": "bend", "node": "ball", "degrees": 300})");
  EXPECT_NE(said.find("are folded or collapsed (det J ≤ 0):"), std::string::npos) << said;
  run(R"({"op": "select_folded"})");
  const std::size_t folded = count(*find(session.scene(), "ball")->selection);
  EXPECT_GT(folded, 10U);
  EXPECT_LT(folded, 1000U);
  said.clear();
  run(R"({"op": "bend", "node": "ball", "degrees": 0}
{"op": "select_folded"})");
  EXPECT_NE(said.find("nothing moved"), std::string::npos) << said;
  const auto now = find(session.scene(), "ball")->selection;
  EXPECT_TRUE(now == nullptr || count(*now) == 0) << "of the last deformation";
}

TEST_F(DeformScript, DuplicatePointsMoveOnceAndGrowthIsReported) {
  run(R"({"op": "cage", "node": "ball", "lattice": [1, 1, 1], "moves": [{"points": [7], "translate": [0.5, 0, 0]}]})");
  const auto once = ball().sets[0].soup.positions();
  run(R"({"op": "undo"})");
  run(R"({"op": "cage", "node": "ball", "lattice": [1, 1, 1], "moves": [{"points": [7, 7, [7, 7]], "translate": [0.5, 0, 0]}]})");
  EXPECT_EQ(ball().sets[0].soup.positions(), once);
  said.clear();
  run(R"({"op": "duplicate", "node": "ball", "as": "second"})");
  EXPECT_EQ(said.find("deformed"), std::string::npos) << "nothing was";
  run(R"({"op": "cage", "node": "second", "lattice": [1, 1, 1], "moves": [{"points": [[0, 7]], "scale": 2}]})");
  EXPECT_NE(said.find("minimum det J 8"), std::string::npos) << said;
  run(R"({"op": "cage", "node": "second", "lattice": [1, 1, 1], "moves": [{"points": [0], "translate": [10, 1, 1]}]})");
  EXPECT_NE(said.find("the moved cage intersects itself ("), std::string::npos) << said;
}

// Vertices of a cage that no face uses move nothing, so they are not taken and shift no pivot.
TEST_F(DeformScript, RegionsOfCagesTakeOnlyVerticesOfFaces) {
  const std::string box = "v -2 -2 -2\nv 4 -2 -2\nv -2 4 -2\nv -2 -2 4\n",
                    faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  write_text(folder_.path() / "plain.obj", box + faces);
  write_text(folder_.path() / "loose.obj", box + "v 0 0 9\n" + faces);
  const auto line = [](const std::string& cage, const std::string& move) {
    return R"({"op": "cage", "node": "ball", "mesh": "{here}/)" + cage + R"(.obj", "moves": [{)" + move + "}]}";
  };
  const std::string turn =
      R"("box": {"min": [-9, -9, -9], "max": [9, 9, 9]}, "rotate": {"axis": [0, 0, 1], "degrees": 20})";
  std::vector<std::vector<Vec3>> turned;
  for (const char* cage : {"plain", "loose"}) {
    run(line(cage, turn));
    turned.push_back(ball().sets[0].soup.positions());
    run(R"({"op": "undo"})");
  }
  EXPECT_EQ(turned[0], turned[1]);
  const std::string near_loose = R"("sphere": {"center": [0, 0, 9], "radius": 0.5}, "translate": [0, 0, 1])";
  expect_error(line("loose", near_loose), "contains no cage vertex");
  const auto before = ball().sets[0].soup.positions();
  run(line("loose", near_loose + R"(, "nearest": true)"));
  EXPECT_NE(ball().sets[0].soup.positions(), before) << "the nearest vertex of a face";
}

TEST_F(DeformScript, JournalStoresTheCageMesh) {
  write_text(folder_.path() / "cage.obj",
             "v -2 -2 -2\nv 4 -2 -2\nv -2 4 -2\nv -2 -2 4\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  run(R"({"op": "cage", "node": "ball", "mesh": "{here}/cage.obj", "moves": [{"points": [3], "translate": [0, 0, 3]}]})");
  const auto after = ball().sets[0].soup.positions();
  const nlohmann::json line = to_json(session.document.history().edits().back());
  std::filesystem::remove(folder_.path() / "cage.obj");
  run(R"({"op": "undo"})");
  session.edit(read_edit(line, session.scene()));
  EXPECT_EQ(ball().sets[0].soup.positions(), after);
}

TEST_F(DeformScript, ScenesStoreRotationsPlainFoldersReportTheLoss) {
  run(R"({"op": "twist", "node": "ball", "degrees": 120})");
  const Image bent = picture();
  said.clear();
  run(R"({"op": "export", "out": "{here}/plain"}
{"op": "save", "out": "{here}/scene"})");
  EXPECT_NE(said.find("how bends rotate colours: ball"), std::string::npos) << said;
  EXPECT_NE(said.find("dB PSNR over four side views"), std::string::npos) << said;
  run(R"({"op": "remove", "node": "ball"}
{"op": "import", "path": "{here}/scene", "as": "ball"})");
  EXPECT_GE(compare(picture(), bent, 2).psnr_db, 60) << "positions are written as decimal numbers";
  run(R"({"op": "remove", "node": "ball"}
{"op": "import", "path": "{here}/plain", "as": "ball"})");
  EXPECT_LT(compare(picture(), bent, 2).psnr_db, 45);
  EXPECT_EQ(ball().sets[0].soup.rotations(), nullptr);
}

TEST_F(DeformScript, ExportKeepsRigidRotations) {
  // A rigid motion by a cage is no bend: it is folded into the decoder, as a node's rotation is.
  run(R"({"op": "cage", "node": "ball", "lattice": [1, 1, 1], "moves": [{"points": [[0, 7]], "rotate": {"axis": [0, 1, 0], "degrees": 90}}]})");
  const Image turned = picture();
  run(R"({"op": "export", "out": "{here}/turned"})");
  EXPECT_EQ(said.find("keeps the colours from before the bend; save"), std::string::npos) << said;
  run(R"({"op": "import", "path": "{here}/turned", "as": "read"}
{"op": "remove", "node": "ball"})");
  EXPECT_GE(compare(picture(), turned, 2).psnr_db, 50);
  // Next to a bend, a rigidly rotated half keeps its rotation.
  run(R"({"op": "select", "node": "read", "half_space": {"point": [0, 0, 0], "normal": [0, 1, 0]}}
{"op": "transform", "node": "read", "selection": true, "rotate": {"axis": [0, 1, 0], "degrees": 90}, "pivot": [0, 0, 0]}
{"op": "bend", "node": "read", "degrees": 5, "box": {"min": [0, 0, 0], "max": [1, 0.1, 1]}, "frame": "bounds"})");
  const Scene flat = without_bends(session.scene());
  std::size_t quarter = 0;
  for (const PackedRotation& turn : *find(flat, "read")->object->sets[0].soup.rotations())
    quarter += std::abs(turn.matrix()(0, 2)) > 0.99 ? 1 : 0;
  EXPECT_GT(quarter, 500U);
}

TEST_F(DeformScript, ReportsSeamsBetweenRotatedParts) {
  run(R"({"op": "select", "node": "ball", "half_space": {"point": [0, 0, 0], "normal": [0, 1, 0]}}
{"op": "transform", "node": "ball", "selection": true, "rotate": {"axis": [0, 1, 0], "degrees": 40}, "pivot": [0, 0, 0]}
{"op": "export", "out": "{here}/apart"})");
  EXPECT_NE(said.find("parts with different rotations now have"), std::string::npos) << said;
  said.clear();
  run(R"({"op": "undo"}
{"op": "transform", "node": "ball", "translate": [0, 1, 0]}
{"op": "export", "out": "{here}/whole"})");
  EXPECT_EQ(said.find("different rotations"), std::string::npos) << said;
}

TEST_F(DeformScript, EmptySphereTakesTheNearestPointIfAllowed) {
  const std::string sphere =
      R"({"op": "cage", "node": "ball", "lattice": [1, 1, 1], "moves": [{"sphere": {"center": [1.5, 1.4, 1.3], "radius": 0.01}, "translate": [0.5, 0, 0])";
  expect_error(sphere + "}]}", "contains no cage vertex");
  run(sphere + R"(, "nearest": true}]})");
  const auto one = ball().sets[0].soup.positions();
  run(R"({"op": "undo"})");
  run(R"({"op": "cage", "node": "ball", "lattice": [1, 1, 1], "moves": [{"points": [7], "translate": [0.5, 0, 0]}]})");
  EXPECT_EQ(ball().sets[0].soup.positions(), one)
      << "the nearest cage point is the corner with the greatest x, y and z";
}

TEST_F(DeformScript, AutomaticAxisFollowsThePart) {
  // The upper half of a long ball bends from its foot, where the lower half touches it.
  run(R"({"op": "transform", "node": "ball", "scale": [1, 4, 1]})");
  run(R"({"op": "select", "node": "ball", "box": {"min": [0, 0.5, 0], "max": [1, 1, 1]}, "frame": "bounds"})");
  const auto before = ball().sets[0].soup.positions();
  run(R"({"op": "bend", "node": "ball", "selection": true, "degrees": 30, "direction": [0, 0, 1], "axis": "auto"})");
  const auto bent = ball().sets[0].soup.positions();
  EXPECT_NE(bent, before);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t v = 0; v < bent.size(); ++v)
    if (bent[v] != before[v]) least = std::min(least, before[v].y());
  EXPECT_GT(least, -0.05) << "the lower half must not move";
  run(R"({"op": "undo"})");
  // The default direction of a bend may be parallel to the axis that is found.
  run(R"({"op": "bend", "node": "ball", "degrees": 30, "axis": "auto", "direction": [0, 1, 0]})");
  EXPECT_NE(ball().sets[0].soup.positions(), before);
  run(R"({"op": "undo"})");
  run(R"({"op": "taper", "node": "ball", "selection": true, "factor": 0.5, "axis": "auto"})");
  EXPECT_NE(ball().sets[0].soup.positions(), before);
  expect_error(R"({"op": "bend", "node": "ball", "degrees": 9, "axis": "auto", "origin": [0, 0, 0]})",
               "cannot be combined with an automatic axis");
  expect_error(R"({"op": "bend", "node": "ball", "degrees": 9, "axis": "up"})", "[x, y, z] or \"auto\"");
}

TEST_F(DeformScript, WarnsOfSharpCornersOfSpines) {
  const auto bend = [&](const char* spine) {
    said.clear();
    run(std::string(R"({"op": "bend", "node": "ball", "degrees": 20, "direction": [1, 0, 0], "spine": )") + spine +
        "}");
    return said.find("has a corner of more than 90° at point 2") != std::string::npos;
  };
  EXPECT_TRUE(bend("[[0, 0, 0], [0, 1, 0], [0, 2, 0], [1, 1, 0]]"));
  EXPECT_FALSE(bend("[[0, 0, 0], [0, 2, 0], [1, 2, 0], [1, 0, 0]]"));
  EXPECT_FALSE(bend("[[0, 0, 0], [0, 1, 0], [0.5, 2, 0]]"));
}

TEST_F(DeformScript, InvalidInputNamesARemedy) {
  expect_error(R"({"op": "cage", "node": "ball", "moves": []})", "at least one move");
  expect_error(R"({"op": "cage", "node": "ball", "lattice": [1, 1], "moves": [{"points": [0]}]})",
               "three whole numbers");
  expect_error(R"({"op": "cage", "node": "ball", "lattice": [0, 1, 1], "moves": [{"points": [0]}]})",
               "at least one cell");
  expect_error(R"({"op": "cage", "node": "ball", "lattice": [1, 1, 1], "wrap": 0.1, "moves": [{"points": [0]}]})",
               "at most one of");
  expect_error(R"({"op": "cage", "node": "ball", "lattice": [1, 1, 1], "moves": [{"points": [8]}]})",
               "the cage has 8 vertices");
  expect_error(R"({"op": "cage", "node": "ball", "moves": [{"box": {"min": [5, 5, 5], "max": [6, 6, 6]}}]})",
               "contains no cage vertex");
  expect_error(R"({"op": "cage", "node": "ball", "moves": [{"translate": [1, 0, 0]}]})",
               "exactly one of points, box and sphere");
  expect_error(R"({"op": "cage", "node": "ball", "wrap": 3, "moves": [{"points": [0]}]})", "between 0.005 and 0.5");
  expect_error(R"({"op": "cage", "node": "ball", "mesh": "{here}/none.obj", "moves": [{"points": [0]}]})", "none.obj");
  const std::string small =
      R"("mesh": {"vertices": [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]], "faces": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]}, )";
  expect_error(R"({"op": "cage", "node": "ball", "coordinates": "green", )" + small + R"("moves": [{"points": [0]}]})",
               "are outside the cage");
  expect_error(R"({"op": "cage", "node": "ball", "coordinates": "bary", "moves": [{"points": [0]}]})",
               "must be mean_value");
  expect_error(
      R"({"op": "cage", "node": "ball", "mesh": {"vertices": [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]], "faces": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]}, "moves": [{"points": [0]}]})",
      "encloses nothing");
  expect_error(
      R"({"op": "cage", "node": "ball", "lattice": [40, 40, 40], "coordinates": "harmonic", "resolution": 256, "moves": [{"points": [0]}]})",
      "at most 2 GB");
  expect_error(
      R"({"op": "cage", "node": "ball", "lattice": [1, 1, 1], "moves": [{"points": [[0, 7]], "translate": [1e308, 0, 0]}]})",
      "would be too large");
  expect_error(R"({"op": "bend", "degrees": 10})", "no triangle is selected");
  expect_error(R"({"op": "taper", "node": "ball", "factor": 2, "spine": [[0, 0, 0], [0, 1, 0]]})", "leave it out");
  expect_error(R"({"op": "bend", "node": "ball", "degrees": 9, "origin": [0, 0, 0], "spine": [[0, 0, 0], [0, 1, 0]]})",
               "cannot be combined with spine, which begins at");
  expect_error(R"({"op": "bend", "node": "ball", "degrees": 9, "spine": [[0, 0, 0]]})", "spine");
  expect_error(R"({"op": "bend", "node": "ball", "degrees": 10, "axis": [0, 0, 0]})", "must be finite and not zero");
  expect_error(R"({"op": "bend", "node": "ball", "degrees": 10, "from": 2, "to": 1})", "must be less than to");
  expect_error(R"({"op": "bend", "node": "ball", "degrees": 10, "falloff": -1})", "must not be negative");
  expect_error(R"({"op": "taper", "node": "ball", "factor": -1})", "not negative");
  expect_error(R"({"op": "handles", "node": "ball", "moves": [{"points": [0]}], "iterations": 0})",
               "between 1 and 1000");
  run(R"({"op": "lock", "node": "ball"})");
  expect_error(R"({"op": "bend", "node": "ball", "degrees": 10})", "is locked");
}

// Where the regions of two handles overlap, the surface must follow each of them, not the sum of their motions.
TEST_F(DeformScript, OverlappingHandlesDoNotAddTheirMotions) {
  const auto highest = [&](double apart) {
    const std::string move = R"({{"sphere": {{"center": [{}{}, 1, 0], "radius": 0.45}}, "translate": [0, 1, 0]}})";
    run(R"({"op": "handles", "node": "ball", "lattice": [6, 6, 6], )"
        R"("fixed": [{"sphere": {"center": [0, -1, 0], "radius": 0.5}}], "moves": [)" +
        fmt::format(fmt::runtime(move), "", apart) + ", " + fmt::format(fmt::runtime(move), "-", apart) + "]}");
    const double top = ball().bounds().max().y();
    run(R"({"op": "undo"})");
    return top;
  };
  EXPECT_NEAR(highest(0.1), 2, 0.1);
  EXPECT_NEAR(highest(0.5), 2, 0.15);
}

// Boxes contain their sides: rounding of a lattice's layers must not decide which of them move.
TEST_F(DeformScript, BoxesInBoundsContainTheLayersOnTheirSidesEverywhere) {
  for (const int cells : {2, 4, 5, 8, 10})
    for (int k = 0; k < 40; ++k) {
      const Vec3 low(0.1 * k, -0.37 * k, 7.7 / (k + 1)), size(1.0 / (k + 3), 0.3 + 0.1 * k, 2.1);
      const Cage cage = lattice_cage(Box(low, Vec3(low + size)), cells, cells, cells);
      CageMove move;
      const double share = 1.0 / cells;
      move.box = BoxRegion{{0, share, 0}, {1, 1, 1}};
      const std::size_t all = cage.vertices.size(), taken = points_of(move, cage, true).size(),
                        layer = static_cast<std::size_t>((cells + 1) * (cells + 1));
      ASSERT_EQ(taken, all - layer) << cells << ' ' << k;
    }
}

// The vertices at both ends of a part are equivalent under a rotation, so their rotations are, wherever it lies.
TEST_F(DeformScript, EndsAtTheDefaultLimitsRotateAlike) {
  for (const char* turn :
       {R"([1, 2, 3], "degrees": 35)", R"([1, 0, 0], "degrees": 30)", R"([1, 0, 1], "degrees": 50)"}) {
    ClosedForm form;
    form.kind = ClosedForm::Kind::twist;
    form.radians = 2;
    const nlohmann::json rotation = nlohmann::json::parse(fmt::format(R"({{"axis": {}}})", turn));
    const Vec3 about(rotation["axis"][0].get<double>(), rotation["axis"][1].get<double>(),
                     rotation["axis"][2].get<double>());
    const Mat3 tilt =
        Eigen::AngleAxisd(rotation["degrees"].get<double>() * std::numbers::pi / 180, about.normalized()).matrix();
    form.axis = tilt * Vec3::UnitY();
    form.direction = tilt * Vec3::UnitX();
    form.from = 0;
    form.to = 2;
    const auto stretched = [&](double height, int k) {
      const double angle = k * std::numbers::pi / 8;
      const Vec3 point = tilt * Vec3(std::cos(angle) / 2, height, std::sin(angle) / 2);
      return (deform(form, point).jacobian - Mat3::Identity()).norm();
    };
    for (const double height : {0.0, 2.0})
      for (int k = 1; k < 16; ++k) EXPECT_NEAR(stretched(height, k), stretched(height, 0), 1e-12) << height << ' ' << k;
  }
}

}  // namespace
}  // namespace rebake::test
