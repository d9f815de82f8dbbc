// Merging of separated nodes: triangles, selections and bytes.
#include <gtest/gtest.h>

#include "tests/support/document_fixture.h"
#include "tests/support/edits.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

class Merge : public DocumentTest {};

TEST_F(Merge, KeepsLiveAndStoredSelections) {
  Document document;
  import(document);
  const auto selected_in = [&](const char* name) {
    const NodePtr node = find(document.scene(), name);
    return node->selection ? *node->selection : TriangleSet();
  };
  act(document, R"({"op": "select", "box": {"min": [-2, -2, -2], "max": [0.3, 2, 2]}})");
  act(document, R"({"op": "store_selection", "name": "left"})");
  const TriangleSet stored = selected_in("ball");
  act(document, R"({"op": "select", "box": {"min": [-2, 0, -2], "max": [2, 2, 2]}})");
  act(document, R"({"op": "separate", "node": "ball", "as": "part"})");
  act(document, R"({"op": "duplicate", "node": "part", "as": "copy"})");
  act(document, R"({"op": "select", "saved": "left"})");
  const std::size_t in_copy = count(selected_in("copy"));
  ASSERT_GT(in_copy, 0U);
  // Merging restores both the live and the stored selection.
  act(document, R"({"op": "merge", "nodes": ["ball", "part"]})");
  EXPECT_EQ(selected_in("ball"), stored);
  act(document, R"({"op": "select", "none": true})");
  act(document, R"({"op": "select", "saved": "left"})");
  EXPECT_EQ(selected_in("ball"), stored);
  act(document, R"({"op": "merge", "nodes": ["copy", "ball"]})");
  EXPECT_EQ(count(selected_in("copy")), count(stored) + in_copy);
}

TEST_F(Merge, OfSeparatedPartsGivesTheOriginalBytes) {
  Document document;
  import(document);
  const auto bytes = exported(document.scene());
  act(document, R"({"op": "select", "sphere": {"center": [0, 1, 0], "radius": 0.8}})");
  act(document, R"({"op": "separate", "node": "ball", "as": "part"})");
  act(document,
      R"({"op": "select", "node": "part", "box": {"min": [0, 0, 0], "max": [0.5, 1, 1]}, "frame": "bounds"})");
  act(document, R"({"op": "separate", "node": "part", "as": "corner"})");
  EXPECT_NE(exported(find(document.scene(), "ball") ? without(document.scene(), find(document.scene(), "part")->id)
                                                    : document.scene()),
            bytes);
  act(document, R"({"op": "merge", "nodes": ["corner", "ball", "part"], "as": "ball again"})");
  EXPECT_EQ(exported(document.scene()), bytes);
}

TEST_F(Merge, SaysThatFilmsMoveAPartDifferently) {
  Document document;
  import(document);
  act(document, R"({"op": "key", "node": "ball", "time": 1, "degrees": 60})");
  act(document, R"({"op": "duplicate", "node": "ball", "as": "copy", "translate": [5, 0, 0]})");
  act(document, R"({"op": "duplicate", "node": "ball", "as": "same"})");
  const auto said = [&](const char* nodes) {
    const nlohmann::json line{{"op", "merge"}, {"nodes", nlohmann::json::parse(nodes)}};
    std::string text;
    for (const std::string& one : carry_out(document.scene(), read_edit(line, document.scene()), {}).report.lines)
      text += one + "\n";
    return text.find("films move \"") != std::string::npos;
  };
  EXPECT_TRUE(said(R"(["ball", "copy"])")) << "another axis";
  EXPECT_FALSE(said(R"(["ball", "same"])"));
  act(document, R"({"op": "key", "node": "copy", "time": 1, "degrees": 60, "remove": true})");
  act(document, R"({"op": "duplicate", "node": "copy", "as": "still"})");
  EXPECT_FALSE(said(R"(["copy", "still"])"));
  act(document, R"({"op": "group", "nodes": ["still"], "as": "g"})");
  act(document, R"({"op": "key", "node": "g", "time": 1, "position": [0, 1, 0]})");
  EXPECT_TRUE(said(R"(["copy", "still"])")) << "a group moves one";
}

TEST_F(Merge, KeepsUnknownMembersAndSaysWhatChanges) {
  Document document;
  import(document);
  act(document, R"({"op": "duplicate", "node": "ball", "as": "copy"})");
  Scene scene = document.scene();
  ASSERT_EQ(scene.roots.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k)
    scene = with_changed(scene, scene.roots[k]->id, [&](Node& node) {
      auto object = std::make_shared<BakedObject>(*node.object);
      object->other_members = {{"author", k == 0 ? "\"a\"" : "\"b\""}, {k == 0 ? "first" : "second", "1"}};
      node.object = object;
      node.visible = k == 0;
    });
  const nlohmann::json line{{"op", "merge"}, {"nodes", {scene.roots[0]->name, scene.roots[1]->name}}};
  const Outcome merged = carry_out(scene, read_edit(line, scene), {});
  const auto& members = merged.scene.roots.front()->object->other_members;
  EXPECT_EQ(members, (std::map<std::string, std::string>{{"author", "\"a\""}, {"first", "1"}, {"second", "1"}}));
  std::string said;
  for (const std::string& one : merged.report.lines) said += one + "\n";
  EXPECT_NE(said.find("another value of \"author\""), std::string::npos) << said;
  EXPECT_NE(said.find("was hidden"), std::string::npos) << said;
}

// A part that is united with its rest gets the rest's values back, but not the numbers of the bodies.
TEST_F(Merge, PartsOfAnObjectKeepTheirBodyBehindAnother) {
  Document document;
  import(document);
  act(document, R"({"op": "duplicate", "node": "ball", "as": "front"})");
  // Another body: the same triangles elsewhere.
  Scene scene = with_changed(document.scene(), find(document.scene(), "front")->id, [](Node& node) {
    auto object = std::make_shared<BakedObject>(*node.object);
    std::vector<Vec3> moved = object->sets[0].soup.positions();
    for (Vec3& p : moved) p.x() += 5;
    object->sets[0].soup = Soup(moved, object->sets[0].soup.uvs(), object->sets[0].soup.faces());
    object->origin = nullptr;
    node.object = object;
  });
  const auto act_on = [&](const char* line) {
    scene = carry_out(scene, read_edit(nlohmann::json::parse(line), scene), {}).scene;
  };
  act_on(R"({"op": "select", "node": "ball", "box": {"min": [-2, 0, -2], "max": [2, 2, 2]}})");
  act_on(R"({"op": "separate", "node": "ball", "as": "part"})");
  act_on(R"({"op": "merge", "nodes": ["front", "ball", "part"]})");
  const BakedObject& merged = *find(scene, "front")->object;
  ASSERT_EQ(bodies_of(merged).size(), 2U);
  for (const TextureSet& set : merged.sets) {
    const auto* body = set.soup.face_attributes().find<std::uint16_t>(BakedObject::body);
    ASSERT_NE(body, nullptr);
    for (std::size_t f = 0; f < set.soup.triangle_count(); ++f)
      EXPECT_EQ((*body)[f], set.soup.positions()[set.soup.faces()[f][0]].x() > 2.5 ? 0 : 1) << f;
  }
}

}  // namespace
}  // namespace rebake::test
