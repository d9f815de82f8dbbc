// Random sequences of edits keep scenes valid, and undo leads back to the start.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "tests/support/document_fixture.h"
#include "tests/support/thorough.h"

namespace rebake::test {
namespace {

using nlohmann::json;
using RandomEdits = DocumentTest;

// Checks that selections match their triangles, and that IDs and names are unique.
void expect_valid(const Scene& scene) {
  std::set<std::uint64_t> ids;
  std::set<std::string> names;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    ASSERT_TRUE(ids.insert(static_cast<std::uint64_t>(placed.node->id)).second);
    ASSERT_TRUE(names.insert(placed.node->name).second);
    ASSERT_LT(static_cast<std::uint64_t>(placed.node->id), scene.next_id);
    if (!placed.node->object) continue;
    ASSERT_GT(placed.node->object->triangle_count(), 0U);
    if (placed.node->selection) {
      ASSERT_EQ(placed.node->selection->size(), placed.node->object->triangle_count());
      ASSERT_GT(count(*placed.node->selection), 0U);
    }
    for (const auto& [name, saved] : placed.node->saved_selections)
      ASSERT_EQ(saved->size(), placed.node->object->triangle_count()) << name;
  }
}

TEST_F(RandomEdits, KeepInvariantsAndUndoToTheStart) {
  export_scene(scene_of(made_object({.columns = 6, .rows = 4, .cell = 4})), path("sources/small"), {});
  Document document({}, 256 << 20);  // less than all scenes need
  std::mt19937 random(3);
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto point = [&] { return json{number(-1, 1), number(-1, 1), number(-1, 1)}; };
  const auto any_node = [&]() -> std::uint64_t {
    const auto placed = placed_nodes(document.scene());
    return placed.empty() ? 0 : static_cast<std::uint64_t>(placed[random() % placed.size()].node->id);
  };
  const char* const modes[] = {"set", "add", "remove", "intersect"};
  const std::vector<std::function<json()>> kinds{
      [&] {
        return json{{"op", "import"}, {"path", path("sources/small").string()}};
      },
      [&] {
        return json{{"op", "duplicate"}, {"node", any_node()}};
      },
      [&] {
        return json{{"op", "group"}, {"nodes", {any_node()}}, {"as", "group"}};
      },
      [&] {
        return json{{"op", "delete"}};
      },
      [&] {
        return json{{"op", "separate"}, {"node", any_node()}};
      },
      [&] {
        return json{{"op", "merge"}, {"nodes", {any_node(), any_node()}}};
      },
      [&] {
        return json{{"op", "grow"}};
      },
      [&] {
        return json{{"op", "shrink"}};
      },
      [&] {
        return json{{"op", "fill"}};
      },
      [&] {
        return json{{"op", "hide"}, {"node", any_node()}};
      },
      [&] {
        return json{{"op", "show"}, {"node", any_node()}};
      },
      [&] {
        return json{{"op", "store_selection"}, {"name", random() % 2 == 0 ? "a" : "b"}};
      },
      [&] {
        return json{{"op", "erase"}, {"sphere", {{"center", point()}, {"radius", 0.1}}}};
      },
      [&] {
        return json{{"op", "transform"},
                    {"node", any_node()},
                    {"selection", true},
                    {"translate", point()},
                    {"rotate", {{"axis", {0, 1, 0}}, {"degrees", number(0, 90)}}}};
      }};
  const std::vector<std::function<json()>> selections{
      [&] {
        return json{{"op", "select"}, {"saved", random() % 2 == 0 ? "a" : "b"}};
      },
      [&] {
        return json{{"op", "select_connected"}, {"point", point()}};
      },
      [&] {
        return json{{"op", "select_like"}, {"point", point()}, {"color", 0.2}};
      },
      [&] {
        return json{{"op", "select_floaters"}, {"at_most", 3}};
      },
      [&] {
        return json{{"op", "select"}, {"sphere", {{"center", point()}, {"radius", number(0.1, 1)}}}};
      }};
  std::size_t done = 0, refused = 0;
  for (int k = 0; k < 1250 * thorough; ++k) {
    json line;
    std::size_t triangles = 0;
    for (const PlacedNode& placed : placed_nodes(document.scene()))
      if (placed.node->object) triangles += placed.node->object->triangle_count();
    if (placed_nodes(document.scene()).size() > 12 || triangles > 1000) {
      line = json{{"op", "remove"}, {"node", any_node()}};
    } else if (random() % 3 == 0) {
      line = selections[random() % selections.size()]();
      line["mode"] = modes[random() % 4];
    } else {
      line = kinds[random() % kinds.size()]();
    }
    try {
      act(document, line);
      ++done;
    } catch (const Error&) {
      ++refused;  // nothing selected or no such node: the document must not change
    }
    if (random() % 20 == 0) document.undo();
    if (random() % 40 == 0) document.redo();
    if (k % 10 == 0) expect_valid(document.scene());
    if (HasFatalFailure()) FAIL() << line.dump();
  }
  EXPECT_GT(done, 375U * thorough);
  EXPECT_GT(refused, 13U * thorough);
  while (document.undo()) expect_valid(document.scene());
  EXPECT_TRUE(document.scene().roots.empty());
  EXPECT_EQ(document.history().undo_count(), 0U);
}

TEST_F(RandomEdits, SelectionAndInverseCoverEverything) {
  Document document;
  import(document);
  for (const json& region :
       {json{{"sphere", {{"center", {0, 1, 0}}, {"radius", 0.8}}}},
        json{{"half_space", {{"point", {0, 0, 0}}, {"normal", {1, 2, 3}}}}}, json{{"connected", {0, 1, 0}}}}) {
    json select = region;
    select["op"] = "select";
    act(document, select);
    const TriangleSet chosen = *document.scene().roots[0]->selection;
    act(document, R"({"op": "select", "invert": true})");
    const NodePtr node = document.scene().roots[0];
    const TriangleSet others = node->selection ? *node->selection : TriangleSet(chosen.size(), 0);
    for (std::size_t f = 0; f < chosen.size(); ++f) ASSERT_NE(chosen[f] != 0, others[f] != 0);
    select["mode"] = "add";
    act(document, select);
    EXPECT_EQ(count(*document.scene().roots[0]->selection), chosen.size());
  }
}

}  // namespace
}  // namespace rebake::test
