// Scripts: parsing, errors that name line and field, selections, and the same bytes at every replay.
#include <fmt/format.h>

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "editor/edits/nodes/place.h"
#include "editor/edits/stored_view.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/polar.h"
#include "mesh_ops/formats/formats.h"
#include "tests/support/made_scenes.h"
#include "tests/support/script_fixture.h"
#include "tests/support/thorough.h"

namespace rebake::test {
namespace {

TEST_F(Script, CommentsBlankLinesAndVariables) {
  run("# comment\n\n  // another\n" + import);
  EXPECT_NE(node("ball"), nullptr);
  EXPECT_EQ(node("ball")->object->triangle_count(), 256U);
}

TEST_F(Script, SelectInEveryFrameAndMode) {
  run(import + R"({"op": "transform", "node": "ball", "translate": [10, 0, 0], "scale": 2})");
  run(R"({"op": "select", "node": "ball", "half_space": {"point": [10, 0, 0], "normal": [0, 1, 0]}})");
  EXPECT_EQ(selected("ball"), 128U);
  run(R"({"op": "select", "node": "ball", "half_space": {"point": [0, 0, 0], "normal": [0, 1, 0]}, "frame": "node", "mode": "intersect"})");
  EXPECT_EQ(selected("ball"), 128U);
  run(R"({"op": "select", "node": "ball", "box": {"min": [0, 0, 0], "max": [1, 0.5, 1]}, "frame": "bounds", "mode": "add"})");
  EXPECT_EQ(selected("ball"), 256U);
  run(R"({"op": "select", "node": "ball", "sphere": {"center": [10, 2, 0], "radius": 1.5}, "mode": "remove"})");
  EXPECT_LT(selected("ball"), 256U);
  const std::size_t before = selected("ball");
  run(R"({"op": "select", "node": "ball", "invert": true})");
  EXPECT_EQ(selected("ball"), 256U - before);
  run(R"({"op": "select", "node": "ball", "none": true})");
  EXPECT_EQ(node("ball")->selection, nullptr);
  run(R"({"op": "select", "node": "ball", "connected": [10, 2, 0]})");
  EXPECT_EQ(selected("ball"), 256U);  // the sphere is one connected component
}

// Numbers of nodes are those of the scene that a script was made on.
TEST_F(Script, NodesByNumberInASceneWithOtherNodesAreSaid) {
  std::string said;
  session.say = [&](const std::string& line) { said += line + "\n"; };
  run(import + R"({"op": "hide", "node": 1})");
  EXPECT_EQ(said.find("by its number"), std::string::npos) << "its own node";
  run(R"({"op": "show", "node": "ball"})");
  EXPECT_EQ(said.find("by its number"), std::string::npos);
  run(R"({"op": "hide", "node": 1})");
  EXPECT_NE(said.find("line 1: gives a node by its number"), std::string::npos) << said;
}

TEST_F(Script, FailedEditKeepsTheScene) {
  run(import + R"({"op": "lock", "node": "ball"})");
  const NodePtr before = node("ball");
  expect_error(R"({"op": "remove", "node": "ball"})", "is locked");
  expect_error(R"({"op": "transform", "node": "ball", "scale": 0})",
               "line 1: field \"scale\": a scale factor must not be 0");
  EXPECT_EQ(node("ball"), before);
  run(R"({"op": "unlock", "node": "ball"})"
      "\n"
      R"({"op": "remove", "node": "ball"})");
  EXPECT_TRUE(session.scene().roots.empty());
}

TEST_F(Script, OrthographicEraseClearsTheVisibleHalf) {
  run(import +
      R"({"op": "view", "name": "flat", "camera": {"eye": [0, 0, 4], "target": [0, 0, 0], "ortho_height": 3}})");
  const auto opaque = [&] { return static_cast<double>(node("ball")->object->opaque_texel_count()); };
  const double all = opaque();
  const std::string whole = R"("view": "flat", "polygon": [[0, 0], [800, 0], [800, 800], [0, 800]])";
  run(R"({"op": "erase", )" + whole + "}");
  EXPECT_NEAR(opaque() / all, 0.5, 0.1) << "only the far half may remain, less the part visible through holes";
  run(R"({"op": "erase", "through": true, )" + whole + "}");
  EXPECT_EQ(opaque(), 0);
}

TEST(StoredViews, SortsNamesNaturally) {
  Scene scene;
  for (const char* name : {"view 10", "view 2", "a", "view 1", "view 02b", ""}) scene.views[name];
  EXPECT_EQ(view_names(scene), (std::vector<std::string>{"", "a", "view 1", "view 2", "view 02b", "view 10"}));
}

TEST_F(Script, RenamesAndRemovesViews) {
  run(import + R"({"op": "view", "name": "front", "camera": {"eye": [0, 0, 4]}})"
               "\n"
               R"({"op": "rename_view", "name": "front", "to": "before"})");
  EXPECT_EQ(session.scene().views.size(), 1U);
  EXPECT_EQ(session.scene().views.at("before").eye, Vec3(0, 0, 4));
  expect_error(R"({"op": "rename_view", "name": "front", "to": "x"})", "the stored views are before");
  run(R"({"op": "view", "name": "other", "camera": {"eye": [0, 0, 5]}})");
  expect_error(R"({"op": "rename_view", "name": "other", "to": "before"})", "another view");
  run(R"({"op": "remove_view", "name": "before"})");
  EXPECT_FALSE(session.scene().views.contains("before"));
  expect_error(R"({"op": "remove_view", "name": "before"})", "the stored views are other");
}

TEST_F(Script, ExportsAndRendersChosenNodes) {
  run(import + R"({"op": "import", "path": "{here}/other", "as": "other"})"
               "\n"
               R"({"op": "transform", "node": "other", "translate": [3, 0, 0]})"
               "\n"
               R"({"op": "group", "nodes": ["other"], "as": "inside"})");
  for (const std::string some : {R"("inside")", R"("other")"})
    run(R"({"op": "export", "out": "{here}/some", "nodes": [)" + some + R"(]})");
  const Scene some = read_any(folder_.path() / "some", Axes::y_up, {});
  ASSERT_EQ(some.roots.size(), 1U);
  EXPECT_EQ(*some.roots[0]->object->decoder, *node("other")->object->decoder);
  run(R"({"op": "render", "out": "{here}/some.png", "nodes": ["inside"], "width": 40, "height": 40, "samples": 1})");
  run(R"({"op": "hide", "node": "ball"})"
      "\n"
      R"({"op": "render", "out": "{here}/hidden.png", "width": 40, "height": 40, "samples": 1})");
  EXPECT_EQ(read_file(folder_.path() / "some.png"), read_file(folder_.path() / "hidden.png"));
  run(R"({"op": "export", "out": "{here}/kept", "format": "rebake", "nodes": ["other"]})");
  const Scene kept = read_any(folder_.path() / "kept", Axes::y_up, {});
  std::vector<std::string> names;
  for (const PlacedNode& placed : placed_nodes(kept)) names.push_back(placed.node->name);
  EXPECT_EQ(names, (std::vector<std::string>{"inside", "other"})) << "in its group, and nothing else";
  expect_error(R"({"op": "export", "out": "{here}/none", "nodes": ["nobody"]})", "nobody");
}

TEST_F(Script, ExportsNameDifferentLayoutsAsTheReasonForFolders) {
  std::string said;
  session.say = [&](const std::string& line) { said += line + "\n"; };
  run(import + R"({"op": "export", "layout": "chunked", "out": "{here}/chunked"}
{"op": "import", "path": "{here}/chunked", "as": "b"}
{"op": "place", "node": "b", "position": [3, 0, 0]}
{"op": "export", "out": "{here}/both"})");
  EXPECT_NE(said.find("one folder holds one file layout (option layout): wrote scene.json with 2 folders"),
            std::string::npos)
      << said;
  EXPECT_EQ(said.find("different rotations"), std::string::npos) << said;
  said.clear();
  run(R"({"op": "place", "node": "b", "rotation": {"axis": [0, 1, 0], "degrees": 40}}
{"op": "export", "layout": "split", "out": "{here}/turned"})");
  EXPECT_NE(said.find("one folder holds one decoder in one orientation: wrote"), std::string::npos) << said;
  EXPECT_NE(said.find("different rotations"), std::string::npos) << said;
}

TEST_F(Script, EditsArePure) {
  run(import);
  const Scene before = session.scene();
  const NodePtr root = before.roots[0];
  const Edit edit = std::get<Edit>(
      read_command(nlohmann::json::parse(R"({"op": "transform", "node": "ball", "translate": [1, 2, 3]})"), before));
  const Scene a = rebake::apply(before, edit).scene, b = rebake::apply(before, edit).scene;
  EXPECT_EQ(before.roots[0], root);
  EXPECT_EQ(root->to_parent.matrix(), Affine::Identity().matrix());
  EXPECT_EQ(a.roots[0]->to_parent.matrix(), b.roots[0]->to_parent.matrix());
  EXPECT_EQ(a.roots[0]->object, root->object);  // shared, not copied
}

TEST_F(Script, EditsRoundTripThroughJson) {
  run(import);
  for (
      const char* line :
      {R"({"op": "select", "node": "ball", "sphere": {"center": [0, 0, 1], "radius": 0.5}, "mode": "add", "frame": "bounds"})",
       R"({"op": "transform", "node": "ball", "rotate": {"axis": [0, 1, 1], "degrees": 30}, "scale": [1, 2, 3], "pivot": [1, 0, 0]})",
       R"({"op": "background", "color": [0, 0.5, 1]})", R"({"op": "reorder", "node": "ball", "index": 0})"}) {
    const Edit edit = std::get<Edit>(read_command(nlohmann::json::parse(line), session.scene()));
    const nlohmann::json written = to_json(edit);
    EXPECT_EQ(to_json(std::get<Edit>(read_command(written, session.scene()))), written) << line;
  }
}

TEST_F(Script, ReplayGivesTheSameBytes) {
  const std::string script = import + R"({"op": "import", "path": "{here}/other", "as": "other"}
{"op": "select", "node": "ball", "sphere": {"center": [0, 1, 0], "radius": 0.8}}
{"op": "transform", "node": "ball", "selection": true, "translate": [0, 0.3, 0], "rotate": {"axis": [1, 0, 0], "degrees": 25}}
{"op": "transform", "node": "other", "translate": [2, 0, 0], "rotate": [0.9, 0, 0.3, 0], "scale": 0.5}
)";
  run(script + R"({"op": "export", "out": "{here}/one"})");
  Session second;
  std::swap(session.document, second.document);
  run(script + R"({"op": "export", "out": "{here}/two"})");
  const auto one = folder_bytes(folder_.path() / "one");
  EXPECT_EQ(one, folder_bytes(folder_.path() / "two"));
  EXPECT_EQ(one.count("scene.json"), 1U);
}

TEST_F(Script, ErrorsNameLineAndField) {
  expect_error("\n{\"op\": \"selekt\"}",
               "s.jsonl: line 2: field \"op\": \"selekt\" is not an edit or action; did you mean \"select\"?");
  expect_error("{\"op\": \"import\"}", "line 1: field \"path\": is missing");
  expect_error("{\"op\": \"import\", \"path\": \"{nope}/x\"}", "the variable {nope} has no value");
  expect_error("{\"op\": \"import\", \"path\": \"/no/such/folder\"}", "/no/such/folder: does not exist");
  expect_error("{\"op\": ", "is not valid JSON at column 8: ");
  expect_error("\n        {\"op\":\"select\" \"all\":true}", "line 2: is not valid JSON at column 28: ");
  expect_error("\xEF\xBB\xBF{\"é\": 1 2}", "line 1: is not valid JSON at column 9: ");
  expect_error("[]", "must be a JSON object");
  expect_error(import + R"({"op": "rename", "nod": "ball", "name": "b"})",
               "line 2: field \"nod\": is not a known field; did you mean \"node\"?");
  expect_error(R"({"op": "select", "box": {"min": [0, 2, 0], "max": [1, 1, 1]}})",
               "line 1: field \"box\": min y is above max y");
  expect_error(R"({"op": "select", "nod": "ball", "all": true})", "did you mean \"node\"?");
  expect_error(R"({"op": "select", "node": "bal", "all": true})", "did you mean \"ball\"?");
  expect_error(R"({"op": "select", "node": "ball", "all": true, "framee": "node"})",
               "field \"framee\": is not a known field; did you mean \"frame\"?");
  expect_error(R"({"op": "select", "node": "ball", "all": true, "foo": 1})",
               "\"foo\": is not a known field; its fields are ");
  expect_error(R"({"op": "light", "effects": []})", "field \"effects\": must contain at least one name");
  expect_error(R"({"op": "select", "node": "ball"})", "exactly one of");
  expect_error(R"({"op": "select", "node": "ball", "sphere": {"center": [0, 0], "radius": 1}})",
               "field \"sphere\": must be a list of three numbers");
  expect_error(R"({"op": "delete"})", "no triangle is selected");
  expect_error(R"({"op": "import", "path": "{here}/ball", "as": "ball"})",
               "is already the name of another node; choose");
  expect_error(R"({"op": "render", "out": "x.png", "view": "nowhere"})", "there is no view \"nowhere\"");
  expect_error(R"({"op": "render", "out": "/no/folder/x.png", "width": 16, "height": 16})",
               "/no/folder: is not a folder");
}

TEST_F(Script, ReportsSelectedAndRemovedCounts) {
  std::vector<std::string> said;
  session.say = [&](const std::string& line) { said.push_back(line); };
  run(import + R"({"op": "select", "sphere": {"center": [0, 9, 0], "radius": 1}}
{"op": "select", "all": true}
{"op": "select", "mode": "remove", "half_space": {"point": [0, 0, 0], "normal": [0, 1, 0]}}
{"op": "delete"}
{"op": "hide", "node": "ball"}
{"op": "transform", "node": "ball", "translate": [0, 1, 0]})");
  EXPECT_EQ(said,
            (std::vector<std::string>{"select: 0 of 256 triangles selected", "select: 256 of 256 triangles selected",
                                      "select: 128 of 256 triangles selected",
                                      "delete: 128 triangles removed, 128 left", "note: \"ball\" is hidden"}));
}

TEST_F(Script, CountsTrianglesOfEditableNodes) {
  std::vector<std::string> said;
  session.say = [&](const std::string& line) { said.push_back(line); };
  run(import + R"({"op": "duplicate", "node": "ball", "as": "other"}
{"op": "select", "all": true}
{"op": "lock", "node": "ball"}
{"op": "select", "node": "other", "mode": "remove", "all": true})");
  EXPECT_EQ(said,
            (std::vector<std::string>{"select: 512 of 512 triangles selected",
                                      "select: 0 of 256 triangles selected; 256 more in hidden or locked nodes"}));
}

TEST_F(Script, SelectAndEraseVariants) {
  run(import +
      R"({"op": "view", "name": "front", "camera": {"eye": [0, 0, 4], "target": [0, 0, 0], "near": 0.1, "far": 10}}
{"op": "select_picture", "view": "front", "polygon": [[300, 300], [500, 300], [500, 500], [300, 500]]})");
  const std::size_t seen = selected("ball");
  EXPECT_GT(seen, 0U);
  run(R"({"op": "select_picture", "view": "front", "polygon": [[300, 300], [500, 300], [500, 500], [300, 500]], "through": true})");
  EXPECT_GT(selected("ball"), seen) << "the far side too";
  run(R"({"op": "select_picture", "view": "front", "brush": {"points": [[400, 400]], "radius": 60}, "mode": "remove"})");
  run(R"({"op": "store_selection", "name": "ring"})");
  const std::size_t ring = selected("ball");
  run(R"({"op": "grow"}
{"op": "shrink"})");
  EXPECT_GE(selected("ball"), ring);
  run(R"({"op": "select", "saved": "ring"})");
  EXPECT_EQ(selected("ball"), ring);
  run(R"({"op": "select_picture", "view": "front", "depth": [3, 3.2]})");
  EXPECT_GT(selected("ball"), 0U);
  run(R"({"op": "select_like", "orientation": 20}
{"op": "select_connected"}
{"op": "select_floaters", "at_most": 5}
{"op": "select_unneeded", "transparent": true, "duplicates": true, "unseen": 16}
{"op": "select", "texture_set": 0})");
  EXPECT_EQ(selected("ball"), 256U);
  const std::uint64_t opaque = node("ball")->object->opaque_texel_count();
  run(R"({"op": "erase", "view": "front", "brush": {"points": [[400, 400]], "radius": 40}})");
  const std::uint64_t near_side = opaque - node("ball")->object->opaque_texel_count();
  EXPECT_GT(near_side, 0U);
  run(R"({"op": "erase", "view": "front", "brush": {"points": [[400, 400]], "radius": 40}, "through": true})");
  EXPECT_GT(opaque - node("ball")->object->opaque_texel_count(), near_side) << "the far side too";
  expect_error(R"({"op": "erase", "node": "ball", "sphere": {"center": [9, 9, 9], "radius": 1}})",
               "nothing was erased");
  expect_error(R"({"op": "select_picture", "view": "front"})", "at least one of polygon, brush and depth");
  expect_error(R"({"op": "select_picture", "polygon": [[0, 0], [1, 0], [0, 1]]})", "exactly one of view and camera");
  expect_error(R"({"op": "select_picture", "view": "back", "depth": [0, 1]})", "there is no view \"back\"");
  expect_error(R"({"op": "select_picture", "view": "front", "polygon": [[0, 0], [1, 0]]})", "at least 3 points");
  expect_error(R"({"op": "select_picture", "view": "front", "brush": {"points": [[0, 0]], "radius": 0}})", "positive");
  expect_error(R"({"op": "select_like", "point": [0, 0, 0]})", "at least one of color");
  expect_error(R"({"op": "select", "texture_set": 1})", "has 1 texture set");
  expect_error(R"({"op": "select", "saved": "none"})", "there is no stored selection");
  run(R"({"op": "lock", "node": "ball"})");
  expect_error(R"({"op": "select_like", "node": "ball", "size": 2})", "is locked");
  expect_error(R"({"op": "select", "all": true})", "no visible, unlocked object");
  run(R"({"op": "unlock", "node": "ball"}
{"op": "hide", "node": "ball"})");
  expect_error(R"({"op": "select_picture", "node": "ball", "view": "front", "depth": [0, 9]})", "is hidden");
}

TEST_F(Script, SelectsTrianglesByNumber) {
  run(import + R"({"op": "select_triangles", "node": "ball", "triangles": [3, [10, 19], 255]})");
  EXPECT_EQ(selected("ball"), 12U);
  EXPECT_EQ((*node("ball")->selection)[255], 1);
  run(R"({"op": "select_triangles", "node": "ball", "triangles": [[0, 10]], "mode": "remove"})");
  EXPECT_EQ(selected("ball"), 10U);
  expect_error(R"({"op": "select_triangles", "node": "ball", "triangles": [256]})", "256 is out of range");
  expect_error(R"({"op": "select_triangles", "node": "ball", "triangles": [[9, 3]]})", "ranges [first, last]");
  expect_error(R"({"op": "select_triangles", "node": "ball", "triangles": [-1]})",
               "must be a list of non-negative whole numbers or");
  run(R"({"op": "group", "nodes": ["ball"], "as": "set"})");
  expect_error(R"({"op": "select_triangles", "node": "set", "triangles": []})", "is a group");
}

TEST_F(Script, UndoAndRedoInAScript) {
  run(import + R"({"op": "remove", "node": "ball"}
{"op": "undo"})");
  EXPECT_NE(node("ball"), nullptr);
  run(R"({"op": "redo"})");
  EXPECT_EQ(node("ball"), nullptr);
  expect_error(R"({"op": "redo"})", "0 edits can be redone");
  expect_error(R"({"op": "undo", "steps": 9})", "2 edits can be undone");
  expect_error(R"({"op": "save_project", "out": "{here}/p.json"})", "must end in .rebake");
}

TEST(ScriptReference, DocsContainEveryField) {
  const std::string docs = read_file(std::filesystem::path(REBAKE_SOURCE) / "editor/script/REFERENCE.md");
  EXPECT_NE(docs.find(command_reference()), std::string::npos) << "run samples/regenerate";
}

}  // namespace
}  // namespace rebake::test
